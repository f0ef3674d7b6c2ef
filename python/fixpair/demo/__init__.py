"""The story of Avila & Adame 2022 (arXiv:2204.11103), small: ``python -m fixpair.demo`` tells it in about a minute."""
