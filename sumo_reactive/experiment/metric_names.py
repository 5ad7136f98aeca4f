"""The metrics of a trial by name: what `TrialResult.metrics` holds, and what each of them is."""

from __future__ import annotations

from sumo_reactive.messages.event import EventKind

METRICS: dict[str, str] = {
    "arrived": "1 if the ego has arrived, else 0",
    "duration_s": "time from departure to the end",
    "time_loss_s": "time lost by driving slower than the road allows",
    "distance_m": "way driven",
    "collisions": "contacts of the ego's box with another",
    "violations": "red lights run and rights of way taken",
    "red_lights_run": "stop lines crossed on red",
    "right_of_way_violations": "users with priority that the ego obstructed",
    "min_time_to_collision_s": "smallest time to collision if both kept their velocities",
    "min_time_to_collision_at_s": "simulation time at which that was",
    "min_post_encroachment_s": "smallest time from when one leaves a place to when the other enters it",
    "hard_braking_caused": "vehicles that braked below -4.6 m/s² behind the ego",
    "max_acceleration_m_s2": "largest acceleration",
    "max_braking_m_s2": "hardest braking, positive",
    "max_lateral_acceleration_m_s2": "largest lateral acceleration",
    "rms_jerk_m_s3": "root mean square of the jerk",
    "standstill_s": "time standing",
    "off_road_s": "time on no lane",
    "emergencies": "times that no command was admissible",
    "emergency_s": "time during which none was",
    "pilot_activations": "steps in which the pilot ran",
    "pilot_free_share": "share of the steps that needed no pilot, 0 to 1",
    **{f"events_{kind.name.lower()}": f"events of the kind “{kind.value}”" for kind in EventKind},
}
