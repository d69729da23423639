"""The bifurcations of branches looked for by another solver: what is asked, how it is found, and the table."""

from lapjoint.campaigns.confirm.running import confirm

__all__ = ["confirm"]
