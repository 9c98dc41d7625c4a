"""The page of the cockpit: a web server in a process of its own.

It shows the states that come over the line, and sends orders back. It never loads
Drake. ``desk`` keeps what all viewers share, ``layout`` builds the page of one,
``panels`` has its parts, ``relay`` passes the 3D view on.
"""
