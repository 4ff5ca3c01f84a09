"""What the section ``camera`` says of its optics beyond focal length and lens: the usable region, and findings."""
