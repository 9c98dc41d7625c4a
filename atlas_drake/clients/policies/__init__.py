"""Learned policies as users: networks that command joints through the command port."""
