"""Branches of periodic motions with a fixed contact sequence: what is asked, followed, found again, and tabulated."""
