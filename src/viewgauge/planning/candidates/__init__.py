"""Candidate viewpoints, sampled around the part, and the directions from which a characteristic is measured."""
