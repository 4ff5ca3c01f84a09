"""Both ends share the pose error: a normal error plus triangular quantization errors, in closed form."""
