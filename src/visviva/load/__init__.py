"""Forces: gravity, springs, dampers, motors, dead and follower loads."""
