"""The story of the paper, small."""
