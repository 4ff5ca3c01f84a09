"""Characteristics that no single viewpoint meets, measured from several viewpoints and averaged."""
