"""Every constant with its unit, symbol and source. Names carry the unit where it is not plain from the name."""

from sumo_reactive.driver.overrides import apply_overrides

# --- world model ------------------------------------------------------------------------------------------------------
SWEPT_WIDTH_M = 2.2
"""Width of the band that a body sweeps along its path: a car of 1.8 m with 0.2 m to spare on either side."""

MIN_REGION_AREA_M2 = 0.01
"""Smaller overlaps of paths that the network itself calls conflicting come from rounding (coordinates hold 1 cm)."""

UNDECLARED_REGION_AREA_M2 = 0.5
"""Overlap that makes a conflict region of paths that the network calls free of conflict: two corners 0.7 m deep."""

SEPARATE_LEVELS_M = 3.0
"""Difference in height of paths that pass over each other; a car and its clearance need about this."""

REGION_STEP_M = 0.25
"""Spacing of the points of a region's outline that are projected on the paths."""

APPROACH_HORIZON_M = 200.0
"""Approach lanes are searched this far upstream of a stop line: 10 s of driving at 20 m/s, above any critical gap."""

OPPOSITE_SLACK_M = 1.0
"""Two edges share a carriageway if their inner lanes lie side by side with at most this room (a painted median) between."""

TAIL_REACH_M = 20.0
"""How far a lane behind a junction is looked at for a part that lies inside the junction's outline."""

HOLD_BACK_REACH_M = 12.0
"""Approach and exit lanes are looked at this far from the stop line for a place where they lie over each other."""

BEFORE_THE_LINE_M = 3.0
"""Where a region begins farther before a stop line than this, nobody is trusted to yield: SUMO's cars look at each other's
times behind the lines only."""

MIN_TAIL_M = 2.0
"""Shorter parts are rounding of the map."""

BORDER_STEP_M = 1.0
"""Spacing of the points of O_S on a road's border: 1.6 m beside one, the nearest is at most 2.1 m away (taxicab)."""


# --- nominal trajectory C ---------------------------------------------------------------------------------------------
CURVE_STEP_M = 0.5
"""Arc length between samples of C."""

LANE_CHANGE_DURATION_S = 3.0
"""Time of a lane change at road speed."""

FAST_CHANGE_SPEED = 15.0
"""m/s; above it a lane change takes longer, for a road that bends leaves less of the lateral acceleration and jerk…"""

FAST_CHANGE_GROWTH = 0.06
"""…by this much per m/s (s²/m): 3.9 s at 30 m/s, with a lateral jerk of 60·3.5 m / T³ = 3.5 m/s³."""

PLAN_HORIZON_M = 2000.0
"""C is planned this far ahead and prolonged before it runs out."""

LANE_CHANGE_ROOM_M = 40.0
"""Room that one lane change should find on an edge; a change with less costs more, so that the plan makes it earlier."""

SHARED_OVERLAP_M = 0.7
"""Lanes of opposite directions that overlap by more are one lane on the map: two cars of 1.8 m do not pass."""

SHARED_LANE_COST = 3.0
"""What such a lane costs, in lane changes."""

LATE_LANE_CHANGE_LENGTH_M = 18.0
"""Length of the latest possible change on C: 1.5 times the minimum, for a car that has already slowed down."""

LANE_CHANGE_CLEARANCE_M = 2.0
"""A change ends this far before its lane does, so that the car stands straight at the stop line."""

MIN_START_BLEND_M = 8.0
"""Shortest transition from the car's pose to the lane's centre: about two car radii."""

MIN_STEP_LATERAL = 0.7
"""m/s²; lateral acceleration that is left for a move aside in the tightest bend."""

MAX_START_BLEND_M = 160.0
"""Longest transition from the car's pose: a lane change at 40 m/s."""

MAX_SWING_OUT_M = 0.3
"""A transition from a pose that heads out of its lane leads at most this much farther out, if the car can turn so soon."""

START_CURVATURE_SHARE = 0.6
"""Share of the car's curvature that the transition to the centre line may use; the road's own bend needs the rest."""

SMOOTHING_LENGTH_M = 1.6
"""Length over which a kink of the centre line is rounded at first; a 4.4 m turn then keeps within 0.15 m of its lane."""

SMOOTHING_GROWTH = 1.35
"""Growth of the smoothing length per pass where C is still too tight; one pass adds some 35 % of deviation."""

SMOOTHING_REACH_M = 5.0
"""A place that is too tight loosens C this far on both sides: half of a car's turn."""

SMOOTHING_PASSES = 9
"""Most passes of smoothing: 1.35⁹ ≈ 15 times the first length; past that COMFORT_DEVIATION_M holds C."""

COMFORT_DEVIATION_M = 0.25
"""C may leave the centre line this far to be driven at the road's speed: half of a car's free room in a 2.8 m lane."""

TURN_REACH = 2.8
"""A turn too tight to steer is refitted this many turning radii on both sides: room to swing out and come back."""

MAX_CENTRING_M = 0.6
"""In a bend a long vehicle keeps to the outside by at most this, as its rear keeps to the inside: farther, its front bumper
would reach into the next lane."""

MAX_STEERING_PER_M = 0.2
"""rad/m; C turns the wheels no faster in a turn that was refitted: 0.8 rad/s at 4 m/s."""

STEERING_MARGIN = 0.95
"""Share of the largest steering angle that C aims at; the executor needs the rest to correct errors."""

CURVE_RUNOUT_M = 10.0
"""C goes on straight this far behind the goal, so that points ahead of the car always exist."""

CURVATURE_WINDOW_M = 2.0
"""Curvature is averaged over this length before it sets a speed: single samples do not brake a car."""


# --- vehicle ----------------------------------------------------------------------------------------------------------
COMFORT_LATERAL_ACCELERATION = 3.0
"""m/s²; cornering speed of the plan is √(this / curvature)."""

MAX_LATERAL_ACCELERATION = 4.0
"""m/s²; a command that exceeds it is discarded (centrifugal limit, F&L 1991, §3.2)."""

WHEELBASE_FRACTION = 0.6
"""Wheelbase / length; passenger cars range from 0.57 to 0.64."""

FRONT_OVERHANG_FRACTION = 0.18
"""From the front axle to the front bumper / length."""

MAX_STEERING_ANGLE = 0.65
"""rad, φmax: a car of 5 m then turns with a front-axle radius of 5 m."""

TURNING_CIRCLE_M = 12.5
"""Radius of the circle within which every vehicle must turn (Directive 96/53/EC, Annex I); long ones steer farther…"""

LONG_VEHICLE_STEERING_ANGLE = 0.9
"""…up to this, rad: the steering lock of buses and trucks."""

MAX_STEERING_RATE = 1.0
"""rad/s, φ̇max."""

COMFORT_DECELERATION = 2.5
"""m/s², planned braking."""

STANDSTILL_GAP_M = 2.0
"""Gap to a standing leader."""


# --- perception -------------------------------------------------------------------------------------------------------
ATTENTION_TIME_S = 8.0
"""The ego looks this long ahead at its present speed."""

ATTENTION_MIN_AHEAD_M = 60.0
"""…but at least this far."""

ATTENTION_BEHIND_M = 90.0
"""How far back a lane is watched before changing onto it: 3 s at 30 m/s of closing speed."""

CORRIDOR_MARGIN_M = 0.2
"""Added to each side of the ego when it asks what stands in its way, unless it sweeps more in a bend."""

WAITING_LENGTH_M = 5.0
"""A car of this length…"""

WAITING_WIDTH_M = 1.8
"""…and width, SUMO's usual ones, is taken to wait inside a junction wherever a turn may."""

ABREAST_M = 4.5
"""Two bodies of up to 2.5 m need 2.8 m between the middles of their ways to pass each other 0.3 m apart, and a long one in a
tight turn 1.7 m more."""

ABREAST_LENGTH_M = 12.0
"""The longest ordinary body, a bus's."""

ABREAST_WIDTH_M = 2.5
"""The widest ordinary body, a truck's or bus's."""

MIN_ABREAST_M = 0.1
"""Who would be nearer than this beside the ego is not passed, nor let pass."""

NARROW_LEAD_S = 0.5
"""The ego goes first through a narrow place if its rear is past it so long before the other comes; at 10 m/s it is 5 m."""

NARROW_HEADWAY = 0.5
"""Share of its time headway that the ego keeps to who is first at a narrow place: he will leave its way again."""

NEAR_M = 45.0
"""Users nearer than this cast U₂ and are tested for contact."""

STATIC_REACH_M = 12.0
"""Taxicab distance up to which exact U₁ sees points of O_S: β·d/12 m is 4 % of α·d, and F moves 7 m in 0.1 s at 70 m/s."""

PROJECTION_WINDOW_M = 8.0
"""How far along C the ego is looked for around its last place: more than one second at 7 m/s, less than a loop."""

PATH_STEP_M = 2.0
"""Spacing of the points on another's foreseen path."""

FORECAST_REACH_M = 300.0
"""Others are foreseen this far: 13 s at 22 m/s."""

SIDE_BY_SIDE_ANGLE = 0.6
"""rad; paths from one road that meet at a smaller angle run beside each other."""


# --- pilot ------------------------------------------------------------------------------------------------------------
MIN_LANE_CHANGE_LENGTH_M = 12.0
"""Room of a lane change at walking speed: a car of 3.6 m turning radius moves 3.2 m aside in 6.4 m; twice that is smooth."""

MAX_ACCELERATION_IN_PLAN = 2.0
"""m/s²; what the pilot counts on when it foresees its own motion (SUMO's default passenger car does 2.6)."""

STANDING_SPEED = 0.1
"""m/s; SUMO counts a vehicle as waiting at or below it."""

STOP_REACHED_M = 2.0
"""A stop counts as reached when the ego stands this close before it."""

YELLOW_S = 3.0
"""The least time that a light is yellow (StVO, at 50 km/h); SUMO's programs have no less unless the user says so."""

RED_MARGIN_S = 0.5
"""A line is passed at yellow, by who brakes for something behind it, so long before red."""

YELLOW_DECELERATION = 3.0
"""m/s²; a yellow is obeyed where this braking suffices (design value of yellow times: 3.0–3.4 m/s²)."""

FOE_ACCELERATION = 1.5
"""m/s²; how a foe may speed up on its way to a region."""

FOE_CAN_STOP_DECELERATION = 4.0
"""m/s²; a foe that must yield is trusted to while this braking suffices (SUMO's default car brakes at 4.5)."""

SIGN_STOP_DECELERATION = 5.5
"""m/s²; a foe that has to stop at an all-way stop, whoever comes, is trusted to while this braking suffices: SUMO's cars
brake for their line with just the 4.5 that is theirs."""

LEAVING_ACCELERATION = 1.0
"""m/s²; no more is counted on of a foe that is seen to gain speed as it leaves the junction: half of what a car does."""

FOE_PATIENCE_S = 3.0
"""A foe with priority that has been standing this long, while the ego has too, is not about to go."""

LEAST_PATIENCE_S = 1.0
"""The longer it has stood, the less the ego need have: the two times together are twice that, the ego's at least this."""

FOLLOWER_DECELERATION = 2.0
"""m/s²; braking that the ego may ask of traffic behind it when it merges, and of itself behind traffic ahead."""

GAP_BEFORE_S = 1.0
"""Margin between leaving a region and the foe's earliest arrival."""

GAP_AFTER_S = 0.5
"""Margin between the foe's leaving a region and the ego's arrival."""

ROLLING_S = 12.0
"""A gap that opens within this time is met rolling; for a later one the ego comes to a stand."""

MERGE_GAP_S = 0.8
"""Time headway that a foe keeps behind the ego after it merged."""

HESITATING_SPEED = 3.0
"""m/s; an ego that moves no faster, and has not come on, has been waiting…"""

HESITATION_S = 1.5
"""…since this long after it last came on: the time of a start."""

ZIPPER_LEAD_M = 0.1
"""Where lanes merge in turns, who is nearer by more than this goes first."""

COMMITTED_PATIENCE = 0.4
"""Share of the margins that still must remain once the ego is inside the junction."""

REGION_MARGIN_M = 0.5
"""Distance kept to a region when waiting inside a junction."""

CROSSER_MARGIN_S = 0.5
"""A crossing car counts as gone if it leaves the corridor this long before the ego comes."""

MEETING_FORESEEN_S = 3.0
"""Who comes towards the ego or crosses is foreseen so far, to see whether he leaves the corridor before they meet: the
time that the comfortable deceleration takes from 7.5 m/s…"""

MEETING_STEP_S = 0.1
"""…in steps of at least this."""

LANE_CHANGE_LOOK_AHEAD_S = 20.0
"""A needed lane change is sought this long before its latest place…"""

LANE_CHANGE_LOOK_AHEAD_M = 150.0
"""…and at least this far."""

LANE_CHANGE_GAP_M = 2.0
"""Gap to both sides of the place on the other lane at standstill…"""

LANE_CHANGE_REACTION_S = 0.5
"""…and the time headway added to it."""

CAUTIOUS_AHEAD_S = 4.0
"""Cautious driving begins this long before a line…"""

CAUTIOUS_AHEAD_M = 10.0
"""…and this far."""

WAIT_SHIFT_M = 4.0
"""A turn waits up to this far before its waiting place inside the junction if the region begins earlier."""

WAIT_INTO_M = 1.0
"""A foe before its line is trusted to wait inside the junction only where its front then reaches no farther into the region:
the ego's way is moved aside by as much. An ego that stands or creeps so little behind its place to wait still waits."""

FOLLOWER_HEADWAY_S = 0.8
"""Time headway left to who is behind on the other lane, while there is still way for another gap."""

URGENT_M = 60.0
"""A change becomes urgent this far before its last place…"""

URGENT_S = 5.0
"""…or this long."""

URGENT_REACTION_S = 0.15
"""Time headway that is left at the last place for a change…"""

URGENT_DECELERATION = 3.5
"""…and the braking (m/s²) that the ego asks of itself there behind who is ahead."""

FEARED_DECELERATION = 4.5
"""m/s²; a follower keeps clear of somebody ahead who may brake so: what SUMO's default car does in normal driving…"""

EASY_STOP_DECELERATION = 3.3
"""…and must then stop with this (m/s²), which at equal speeds of 28 m/s is a headway of 1.2 s…"""

HARD_STOP_DECELERATION = 3.8
"""…and with this at the last place for a change: SUMO's cars brake 1.2 times as hard as they must, here 4.6 m/s²…"""

FOLLOWER_STANDSTILL_GAP_M = 2.5
"""…and with this gap at standstill (SUMO's minGap)."""

OFF_THE_LINE_M = 1.5
"""A car that moves this near to its all-way stop line has stopped there already and now goes (SUMO halts at 1 m)."""

ENTERING_M = 6.0
"""Nearer than this to its line the ego goes after a foe only if that foe is sure to go."""


BEHAVIOUR_TOLERANCE = 1.0
"""m/s; another road user keeps its behaviour as long as its speed differs less from the foreseen one."""

OFF_NOMINAL_SPEED = 3.0
"""m/s; "v far from nominal" (F&L 1991, §2): a fifth of city speed."""

TRUST_S = 0.4
"""Near an intersection, and while a gap is sought, the others are foreseen anew after this long…"""

TRUST_AHEAD_S = 1.0
"""…and after this long while the intersection is still far."""

DELAY_STEP_S = 5.0
"""A delay is excessive, each time, when it has grown by this much."""

NO_PROGRESS_S = 20.0
"""An ego that has not come on for this long, though nobody has the right to block it, looks for an escape."""

MISSED_TURN_S = 25.0
"""An ego that has waited so long at the end of its lane, while traffic keeps passing, looks for another way…"""

QUEUE_HEADWAY_S = 2.0
"""A queue lets one car after another pass the line at this interval, at saturation."""

TURNER_WAIT_S = 10.0
"""What somebody in the queue who turns off and has to let others go first adds to the wait: two or three gaps refused."""

TURNERS_FEARED = 2
"""More of them in one queue are not counted: nobody knows how many go in one gap."""

QUEUE_GAIN_S = 9.0
"""A queue is left for one that is expected to be shorter by this for each lane change, which costs comfort and may not come
to pass: less than a red light costs, more than four cars."""

QUEUED_SPEED = 3.0
"""m/s; who is slower than this before the line is in the queue."""

HEAD_STANDS_S = 2.0
"""The head of a queue that stands for less while it may go is about to start; for longer, it waits for something else."""

SWING_OUT_M = 6.0
"""Room behind somebody who stands that a car needs to leave the lane past him; HALTED_ROOM_M is what it keeps if it can."""

QUEUE_PATIENCE_S = 90.0
"""…and one that waits beside a queue, or farther back, after this long: a light's cycle."""

AT_LANE_END_M = 5.0
"""At the end of its lane is who is not farther than a car's length from the last place to change."""

CALL_OFF_SHARE = 0.3
"""A lane change may be called off on this share of its length: a car of 1.8 m on a lane of 3.2 m then touches the line."""

CREEPING_SPEED = 1.0
"""m/s; who is slower than this creeps, and still waits."""

PROGRESS_M = 3.0
"""Coming on means this far."""

ASSESSED_S = 8.0
"""The planned manoeuvre is simulated this far ahead: approach and crossing of an intersection at city speed."""

ASSESSMENT_STEP_S = 0.2
"""Step of that simulation: 2.8 m at city speed, less than a car's length."""

EXCESSIVE_DELAY_S = 5.0
"""k₂ (F&L 1991, §2): a plan that will be later than this is degraded."""


SETTLED_SPEED = 1.0
"""k₁ (F&L 1991, §2), m/s: the ego has settled behind X if its speed differs less from what following X allows."""

SLOW_SHARE = 0.75
"""X is worth overtaking below this share of the road's speed…"""

SLOWER_BY = 2.5
"""…and if it is slower by this much (m/s): a pass then takes less than ten seconds."""

FOLLOWING_M = 12.0
"""The ego follows X with a gap up to this…"""

FOLLOWING_S = 2.0
"""…and this time headway;"""

HALTED_AHEAD_S = 4.0
"""somebody who has halted counts from this far on, so that the ego need not stop behind him."""

OFF_CURVE_EPSILON_M = 0.3
"""ε (F&L 1991, §2): the ego is back on C when it is nearer than this."""

PASSING_CLEARANCE_M = 0.65
"""Room left beside who is passed: a car of 1.8 m then still touches its own lane of 3.2 m, where SUMO maps it…"""

TWO_WHEELER_CLEARANCE_M = 1.2
"""…and beside two-wheelers, which sway."""

TWO_WHEELER_WIDTH_M = 1.2
"""A narrower vehicle is one."""

EDGE_MARGIN_M = 0.1
"""Room kept to the border of the own lane when somebody is passed within it."""

OVERTAKING_END_M = 30.0
"""No overtaking nearer to an intersection than this; the last metres are for coming back before…"""

HALTED_END_M = 3.0
"""…and past somebody who has halted, than this."""

HALTED_GAP_M = 1.0
"""Gap left in front of somebody who has halted, before coming back."""

RETURN_HEADWAY_S = 0.8
"""Time headway left to who has been passed…"""

RETURN_GAP_M = 3.0
"""…and this gap."""

OVERTAKING_S = 25.0
"""No overtaking takes longer."""

PROOF_ROOM_M = 0.2
"""Room around the ego's body that the proof asks for before it pulls out."""

OVERTAKING_MARGIN_S = 3.5
"""Oncoming traffic may be this much earlier than foreseen, or half of it later, and an overtaking still meets nobody…"""

UNDER_WAY_SHARE = 0.6
"""Share of these margins that must remain while the ego passes: a small error does not call it back."""

PASSING_HEADWAY = 0.6
"""Share of the driver's time headway kept to X while pulling out."""

MERGE_MARGIN_S = 1.0
"""…and traffic on the lane beside that drives the ego's way this much."""

OVERTAKING_SIGHT_M = 600.0
"""How far the ego looks along the oncoming lane when it wants to overtake: 14 s at 22 m/s towards each other."""

HALTED_ROOM_M = 8.0
"""The ego stops this far behind somebody who has halted: room to swing out."""

BACK_UP_CLEAR_M = 2.0
"""Room that must be left behind the ego after backing up."""

BACK_UP_SPEED = 1.0
"""m/s; walking speed."""

MOVE_SPEED = 2.0
"""m/s; how fast the moves of a turn are driven where the road is too narrow for one sweep…"""

MOVE_BACK_SPEED = 1.5
"""m/s; …and how fast those backwards."""

MOVE_CHANGE_S = 3.0
"""What changing between forwards and backwards takes, with the wheels turned from lock to lock, s."""

MOVE_SIGHT_M = 0.8
"""A move goes on while the ego's body touches nobody this far beyond where it could stop."""

MOVE_END_M = 0.04
"""A move is over when less of its way is left."""

WHEELS_TURNED_RAD = 0.03
"""A move begins when the wheels are this near to its steering angle."""

TURNAROUND_REACHED_M = 1.5
"""An ego that stands this near to where it turns round begins."""

TURNAROUND_PATIENCE_S = 30.0
"""Who comes over the ground that a turn needs is let pass, until the ego has stood there for so long."""

TURNAROUND_LEAD_M = 30.0
"""A turn's sweep is tried from this far before it to this far behind it, more than a car needs to swing out and back."""

TURNAROUNDS_KEPT = 1024
"""Turns that are worked out once are kept for so many connections."""

FALL_BACK_BY = 4.0
"""m/s; so much slower than X the ego drops back beside it."""

UPDATE_ASIDE_M = 4.0
"""The place of return is planned anew when it moves by more."""


# --- executor ---------------------------------------------------------------------------------------------------------
COMFORT_JERK = 8.0
"""m/s³; the lattice of commands changes the acceleration by no more, unless safety needs it."""

LOOK_AHEAD_S = 0.2
"""U₁ is taken where the front axle will be this long after the control period, the steering held."""

LOOK_AHEAD_GROWTH = 0.02
"""s per m/s; the look-ahead grows with speed so that fast driving steers gently."""

MIN_LOOK_AHEAD_M = 0.6
"""…but at least this far ahead, so that a standing car knows where to steer."""

VALLEY_ATTRACTION = 1.0
"""α of U₁, 1/m (F&L 1991, §3.3.1)."""

VALLEY_REPULSION = 0.5
"""β of U₁ (F&L 1991, §3.3.1)."""

SHADOW_SCALE = 1.0
"""k₀ of U₂, s (F&L 1991, §3.3.2)."""

SHADOW_HORIZON_M = 40.0
"""Obstacles farther away cast no potential."""

CLEARANCE_M = 1.2
"""Room that the ego likes to have beside whom it passes; cars in the middles of lanes of 2.8 m have it."""

MAX_LEAN_M = 0.4
"""It takes it inside its lane, this far beside C at most."""

COLLISION_HORIZON_S = 0.7
"""Predicted footprints are tested this far; beyond, the others' headings no longer hold and the regions decide."""

COLLISION_STEP_S = 0.1
"""Time between tested footprints."""

ROLLING_SHARE = 0.35
"""An ego slows down for a gap that is to open from where this share of the comfortable braking would stop it on: farther
away the gap before the foe may yet turn out to be enough."""

ROLLING_APPROACH_S = 3.0
"""Time constant with which the ego slows down for a gap that is foreseen to open."""

SPEED_APPROACH_S = 0.6
"""Time constant with which the ego approaches a speed limit from below."""

SAFE_GAP_M = 0.5
"""Gap that must remain when ego and leader have both braked as hard as they can."""

STOP_LINE_MARGIN_M = 0.7
"""Planned distance of the front bumper to a line."""

ON_LINE_M = 0.05
"""A front bumper no farther over a line than this is at it: a car inserted at the very end of its lane, or one that has
stopped there, has not passed its light. SUMO's lanes and C agree to less."""

TURN_FORESEEN_S = COLLISION_HORIZON_S
"""The others' turning is taken over this time, along their lanes."""

HARD_STOP_MARGIN_M = 0.15
"""Distance to a line that no admissible command gives up; a line that asks late is stopped at so near."""

COARSE_STOP_MARGIN_M = 0.4
"""The same for nine commands, each held half a second: with less they creep on until it is too late to stop."""

MAX_LATERAL_JERK = 14.0
"""m/s³; bounds φ̇max at road speed. With 8 a car at 30 m/s needed 0.9 s to reverse its steering and wove about C."""

PAPER_LATERAL_STEP = 1.1
"""m/s²; most that one of the nine commands changes the lateral acceleration: coarser, it weaves; finer, it turns late."""

PAPER_STEERING_SPEED = 4.0
"""m/s; below it φ̇max of the nine commands no longer grows: a tight turn is driven about so fast."""

TIME_TOLERANCE_S = 2.0
"""The ego slows down for a time constraint only if it would be earlier than this."""

MAP_SIDE_M = 100.0
"""Side l of the world window that a bitmap covers; a cell is l/500 = 0.2 m (F&L 1991, §4)."""

SLOT_HEADWAY_S = 0.4
"""Time headway to the vehicle on the other lane behind which the ego falls in."""

SPEED_SLACK = 0.5
"""m/s above the road's speed that comfortable braking takes back…"""

EXCESS_GAIN = 2.0
"""…beyond it the ego brakes harder by this much per m/s (1/s)."""

BRAKING_SHARE = 0.8
"""Share of the way to the hard margin within which a late stop is planned, where the comfortable margin is used up."""

PLANNED_DECELERATION = 3.0
"""m/s²; hardest braking that is no emergency: what a yellow asks for. Harder is an emergency, and only where this braking
does not stop clear."""

PRESSING_GAIN = 3.0
"""Where a stop or a leader needs more than comfortable braking, the ego brakes by this many times the difference harder at
once, up to the planned: the way that is won early spares an emergency."""

BEND_SHARE = 0.9
"""Share of the largest lateral acceleration that a bend may take which comes too soon for the comfortable one."""

BEND_ENTRY_S = 0.5
"""s; what a bend asks for nearer than this is braked for harder than planned only if the car would be carried off C…"""

BEND_ROOM_M = 0.7
"""…by more than this: a car of 1.8 m in the middle of a lane of 3.2 m leaves it."""


# --- control step -----------------------------------------------------------------------------------------------------
CONTROL_PERIOD_S = 0.1
"""Longest control period δt of the default profile; a coarser simulation step is sub-stepped."""

PAPER_CONTROL_PERIOD_S = 0.5
"""δt of the paper (F&L 1991, §4)."""

WITHOUT = 0
"""Number of the mechanism that is left out, see `ablation.py`; 0: none. `tools/ablation.py` measures what is then lost."""

MAP_MARGIN_M = 20.0
"""A new bitmap is drawn when the ego comes this near to the rim."""


# --- hand-over in SUMO ------------------------------------------------------------------------------------------------
MIN_PATH_LENGTH_M = 0.1
"""Shortest spine or path; networks hold shapes of two equal points."""

LANES_REFRESH_M = 5.0
"""The lanes in sight are chosen anew each time the ego has come this far."""

ROUTE_REFRESH_S = 3.0
"""Another vehicle's route is read anew after this long, for it may have been re-routed."""

PERSON_DECELERATION = 5.0
"""m/s²; a pedestrian stops within a step."""

STEPPING_ON_M = 4.0
"""Somebody on a walking area who is this near to the crossing that he heads for is about to step on: 3 s of walking."""

TELEPORT_GUARD_S = 5.0
"""The ego ends its waiting time this long before SUMO would teleport it."""

OBSTACLE_POLYGONS = "obstacle"
"""Polygons of this type stand on the road, unless the scenario names another."""

OUTLINE_STEP_M = 0.5
"""Spacing of the points of O_S on the outline of a parked vehicle or a polygon: a tenth of a car's length."""

STATIC_SIGHT_M = 60.0
"""Parked vehicles and polygons are points of O_S up to this far in x and y: half a bitmap's side, and a refresh more."""

POLYGON_REACH_M = 150.0
"""Polygons on the road are seen this far: braking from 25 m/s takes 125 m."""

THIN_POLYGON_M = 0.05
"""Half the width of a polygon that is but a line or a point."""

PLAN_RESERVE_M = 600.0
"""C is prolonged when less than this is left of it and the goal is not on it (braking from 50 m/s takes 500 m)."""

OFF_CURVE_M = 1.5
"""An ego this far from C plans anew from where it is."""

CUT_M = 0.6
"""A body that covers the lane beside by more than this in a bend is shown there: SUMO's cars, in the middle of 3.2 m, leave
0.7 m."""

PLANS_KEPT = 512
"""What is worked out once for a plan is kept for so many: one for each of several hundred egos."""

CUT_SIGHT_M = 60.0
"""So far ahead the driver looks for a place where the body will cut into the lane beside: enough to stop in town."""

CUT_PATIENCE_S = 15.0
"""After so long a wait for a gap to cut into, the ego takes one that those behind must brake for, though not hard."""

CUT_SEEN_S = 2.0
"""So long before, at the present speed: who comes from behind needs as much to fall back."""

STRADDLE_M = 0.1
"""A body nearer than this to a lane border is taken to reach over it."""

DETOUR_PATIENCE_S = 90.0
"""An ego that missed a turn waits on for as long as the other way takes longer, but no longer than this, a light's cycle."""

STUCK_S = 600.0
"""s; an ego that has been standing this long ends the run as not arrived."""


# --- trials in processes of their own --------------------------------------------------------------------------------
MAX_TRIALS = 100
"""Trials that one process runs before another takes its place: its start (1 s) is then 10 ms a trial."""

MAX_MEMORY_MB = 4096.0
"""MB; a process that holds more ends its trial as crashed: ten times what a city network takes."""

RECYCLE_MEMORY_MB = 1536.0
"""MB; a process that holds more after a trial is replaced before the next."""

SCHEDULER_PATIENCE_S = 10.0
"""s; a scheduler that has not answered until then is not there."""


apply_overrides(globals())
