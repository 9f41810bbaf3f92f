"""Reproduce what arXiv:1907.00553 shows and says: claims and figures, published beside the certificate."""
