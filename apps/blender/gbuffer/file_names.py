"""Names of files that are written beside the scene file."""


def unique(kind, name, ending, taken):
    """A file name that is not in `taken`, which gets it. Names in Blender may differ in signs alone, and
    instances share theirs."""
    stem = f"{kind}_" + "".join(c if c.isalnum() or c == "-" else "_" for c in name)
    number, file = 1, stem + ending
    while file.lower() in taken:  # some disks know no letter case
        number += 1
        file = f"{stem}_{number}{ending}"
    taken.add(file.lower())
    return file
