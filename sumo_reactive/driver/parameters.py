"""Every constant with its unit, symbol and source. Names carry the unit where it is not plain from the name."""

from sumo_reactive.driver.overrides import apply_overrides

# --- world model ------------------------------------------------------------------------------------------------------

# --- nominal trajectory C ---------------------------------------------------------------------------------------------

# --- vehicle ----------------------------------------------------------------------------------------------------------
COMFORT_LATERAL_ACCELERATION = 3.0
"""m/s²; cornering speed of the plan is √(this / curvature)."""

MAX_LATERAL_ACCELERATION = 4.0
"""m/s²; a command that exceeds it is discarded (centrifugal limit, F&L 1991, §3.2)."""

MAX_STEERING_RATE = 1.0
"""rad/s, φ̇max."""

COMFORT_DECELERATION = 2.5
"""m/s², planned braking."""

STANDSTILL_GAP_M = 2.0
"""Gap to a standing leader."""


# --- perception -------------------------------------------------------------------------------------------------------

CORRIDOR_MARGIN_M = 0.2
"""Added to each side of the ego when it asks what stands in its way, unless it sweeps more in a bend."""

NARROW_LEAD_S = 0.5
"""The ego goes first through a narrow place if its rear is past it so long before the other comes; at 10 m/s it is 5 m."""

NARROW_HEADWAY = 0.5
"""Share of its time headway that the ego keeps to who is first at a narrow place: he will leave its way again."""

# --- pilot ------------------------------------------------------------------------------------------------------------

MAX_ACCELERATION_IN_PLAN = 2.0
"""m/s²; what the pilot counts on when it foresees its own motion (SUMO's default passenger car does 2.6)."""

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

COMMITTED_PATIENCE = 0.4
"""Share of the margins that still must remain once the ego is inside the junction."""

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

EASY_STOP_DECELERATION = 3.3
"""…and must then stop with this (m/s²), which at equal speeds of 28 m/s is a headway of 1.2 s…"""

HARD_STOP_DECELERATION = 3.8
"""…and with this at the last place for a change: SUMO's cars brake 1.2 times as hard as they must, here 4.6 m/s²…"""

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

QUEUE_GAIN_S = 9.0
"""A queue is left for one that is expected to be shorter by this for each lane change, which costs comfort and may not come
to pass: less than a red light costs, more than four cars."""

QUEUE_PATIENCE_S = 90.0
"""…and one that waits beside a queue, or farther back, after this long: a light's cycle."""

PROGRESS_M = 3.0
"""Coming on means this far."""

ASSESSED_S = 8.0
"""The planned manoeuvre is simulated this far ahead: approach and crossing of an intersection at city speed."""

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

OFF_CURVE_EPSILON_M = 0.3
"""ε (F&L 1991, §2): the ego is back on C when it is nearer than this."""

PASSING_CLEARANCE_M = 0.65
"""Room left beside who is passed: a car of 1.8 m then still touches its own lane of 3.2 m, where SUMO maps it…"""

TWO_WHEELER_CLEARANCE_M = 1.2
"""…and beside two-wheelers, which sway."""

OVERTAKING_END_M = 30.0
"""No overtaking nearer to an intersection than this; the last metres are for coming back before…"""

RETURN_HEADWAY_S = 0.8
"""Time headway left to who has been passed…"""

RETURN_GAP_M = 3.0
"""…and this gap."""

OVERTAKING_S = 25.0
"""No overtaking takes longer."""

OVERTAKING_MARGIN_S = 3.5
"""Oncoming traffic may be this much earlier than foreseen, or half of it later, and an overtaking still meets nobody…"""

MERGE_MARGIN_S = 1.0
"""…and traffic on the lane beside that drives the ego's way this much."""

OVERTAKING_SIGHT_M = 600.0
"""How far the ego looks along the oncoming lane when it wants to overtake: 14 s at 22 m/s towards each other."""

HALTED_ROOM_M = 8.0
"""The ego stops this far behind somebody who has halted: room to swing out."""

TURNAROUND_PATIENCE_S = 30.0
"""Who comes over the ground that a turn needs is let pass, until the ego has stood there for so long."""

# --- executor ---------------------------------------------------------------------------------------------------------
COMFORT_JERK = 8.0
"""m/s³; the lattice of commands changes the acceleration by no more, unless safety needs it."""

LOOK_AHEAD_S = 0.2
"""U₁ is taken where the front axle will be this long after the control period, the steering held."""

LOOK_AHEAD_GROWTH = 0.02
"""s per m/s; the look-ahead grows with speed so that fast driving steers gently."""

VALLEY_ATTRACTION = 1.0
"""α of U₁, 1/m (F&L 1991, §3.3.1)."""

VALLEY_REPULSION = 0.5
"""β of U₁ (F&L 1991, §3.3.1)."""

SHADOW_SCALE = 1.0
"""k₀ of U₂, s (F&L 1991, §3.3.2)."""

CLEARANCE_M = 1.2
"""Room that the ego likes to have beside whom it passes; cars in the middles of lanes of 2.8 m have it."""

MAX_LEAN_M = 0.4
"""It takes it inside its lane, this far beside C at most."""

COLLISION_HORIZON_S = 0.7
"""Predicted footprints are tested this far; beyond, the others' headings no longer hold and the regions decide."""

ROLLING_SHARE = 0.35
"""An ego slows down for a gap that is to open from where this share of the comfortable braking would stop it on: farther
away the gap before the foe may yet turn out to be enough."""

SPEED_APPROACH_S = 0.6
"""Time constant with which the ego approaches a speed limit from below."""

STOP_LINE_MARGIN_M = 0.7
"""Planned distance of the front bumper to a line."""

MAX_LATERAL_JERK = 14.0
"""m/s³; bounds φ̇max at road speed. With 8 a car at 30 m/s needed 0.9 s to reverse its steering and wove about C."""

TIME_TOLERANCE_S = 2.0
"""The ego slows down for a time constraint only if it would be earlier than this."""

SLOT_HEADWAY_S = 0.4
"""Time headway to the vehicle on the other lane behind which the ego falls in."""

PLANNED_DECELERATION = 3.0
"""m/s²; hardest braking that is no emergency: what a yellow asks for. Harder is an emergency, and only where this braking
does not stop clear."""

PRESSING_GAIN = 3.0
"""Where a stop or a leader needs more than comfortable braking, the ego brakes by this many times the difference harder at
once, up to the planned: the way that is won early spares an emergency."""

# --- control step -----------------------------------------------------------------------------------------------------
CONTROL_PERIOD_S = 0.1
"""Longest control period δt of the default profile; a coarser simulation step is sub-stepped."""

PAPER_CONTROL_PERIOD_S = 0.5
"""δt of the paper (F&L 1991, §4)."""

WITHOUT = 0
"""Number of the mechanism that is left out, see `ablation.py`; 0: none. `tools/ablation.py` measures what is then lost."""

# --- hand-over in SUMO ------------------------------------------------------------------------------------------------

CUT_PATIENCE_S = 15.0
"""After so long a wait for a gap to cut into, the ego takes one that those behind must brake for, though not hard."""

DETOUR_PATIENCE_S = 90.0
"""An ego that missed a turn waits on for as long as the other way takes longer, but no longer than this, a light's cycle."""

STUCK_S = 600.0
"""s; an ego that has been standing this long ends the run as not arrived."""


# --- trials in processes of their own --------------------------------------------------------------------------------

apply_overrides(globals())
