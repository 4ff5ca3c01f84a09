"""Pictures of the part: in three dimensions, and as the camera sees it."""
