"""How numba is used: functions that are compiled to machine code, and the cache on disk that keeps that code."""
