"""`sumo_reactive`: a reactive external driver for SUMO after Fraichard & Laugier (ICRA 1991)."""

__version__ = "0.1.0"
