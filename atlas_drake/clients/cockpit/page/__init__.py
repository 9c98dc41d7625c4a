"""The page of the cockpit: a web server in a process of its own.

It passes on what comes over the line, and makes messages and requests of what browsers
ask for. ``session`` knows the viewers and who has control, ``actions`` what a browser
may ask for, ``access`` who may open the page; ``relay`` passes the 3D view on;
``sockets`` are those of browsers, which may be slow; ``static`` is what runs there.
"""
