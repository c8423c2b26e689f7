"""A robot in a page while a program moves it: server, news, commands."""
