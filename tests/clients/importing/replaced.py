"""Words that tests replace in a published URDF: what they find, what they put."""


def limits(joint, text):
    return rf'(<joint name="{joint}".*?<limit )[^/]*/>', rf"\g<1>{text} />"
