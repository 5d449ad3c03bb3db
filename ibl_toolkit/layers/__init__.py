"""Panoramas in layers (POMC, thesis chapter 6): the model, its files, and what is made of them."""
