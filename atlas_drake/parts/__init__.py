"""Parts: abilities that a robot stands and walks without, one folder each.

No part imports another, and nothing below ``shipped`` imports a part.
"""
