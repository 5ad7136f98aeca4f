"""Vehicle classes: the words in which a road says who may use it."""

VEHICLE_CLASSES = frozenset(
    {
        "private", "emergency", "authority", "army", "vip", "pedestrian", "passenger", "hov", "taxi", "bus", "coach",
        "delivery", "truck", "trailer", "motorcycle", "moped", "bicycle", "evehicle", "tram", "rail_urban", "rail",
        "rail_electric", "rail_fast", "ship", "container", "cable_car", "subway", "aircraft", "wheelchair", "scooter",
        "drone", "custom1", "custom2",
    }
)  # fmt: skip
"""Every class that a lane can allow or forbid (SUMO 1.28)."""
