"""Figure 8.7: a triangulation that is pulled apart, and the link of one of a pair of knots, by spview --apart."""

from functions import KNOTS, VERTEX, Basis
from programs import run

WIDTH = 480


def picture(stream, left, *flags):
    """A picture of spview, to be placed in another one."""
    svg = run("spview", "--quiet", "--apart", "--width", WIDTH, *flags, "-", stdin=stream).decode()
    # Two pictures in one document must not share ids.
    for name in ("window", "map"):
        svg = svg.replace(f'id="{name}"', f'id="{name}-{left}"').replace(f"url(#{name})", f"url(#{name}-{left})")
    return svg.replace("<svg ", f'<svg x="{left}" y="0" ', 1).strip()


def draw(folder):
    stream = Basis(KNOTS, "--pull-apart", "all").stream
    parts = [picture(stream, 0, "--order", 1), picture(stream, WIDTH, "--set", VERTEX)]
    height = max(int(part.split('height="')[1].split('"')[0]) for part in parts)
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {2 * WIDTH} {height}" role="img">'
    title = "<title>A triangulation whose knots are pulled apart, and the link of one of a pair</title>"
    (folder / "figure-8.7.svg").write_text("\n".join([head, title, *parts, "</svg>", ""]))
