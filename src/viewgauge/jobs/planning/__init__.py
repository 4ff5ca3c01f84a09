"""The main job step by step: search of the candidates, choice, refinement, averaging, proof."""
