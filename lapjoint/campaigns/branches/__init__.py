"""Branches of periodic motions with a fixed contact sequence: what is asked, followed, found again, and tabulated."""

from lapjoint.campaigns.branches.running import branch, find_branches

__all__ = ["branch", "find_branches"]
