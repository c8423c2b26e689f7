"""Robots as they look: in a browser, in one page that replays a run, as video, as stills."""
