"""The vehicle: kinematic model and limits (F&L 1991, §3.1)."""
