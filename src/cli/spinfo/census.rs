//! What `spinfo --count-violations` prints.

use serde_json::{Value, json};

use spmesh_audit::{Faults, Figures};

/// A line per kind of fault; those that arithmetic finds with their share, exactly and in plain floating
/// point.
pub(super) fn text(figures: &Figures) -> String {
    let total = figures.tetrahedra;
    let mut text =
        format!("violations among {total} tetrahedra {:>20} {:>27}\n", "exactly", "in floating point");
    let mut of_tetrahedra = |name: &str, count: fn(&Faults) -> u64, meaning: &str| {
        let [exact, float] = [&figures.exact, &figures.float]
            .map(|faults| format!("{} ({:.4} %)", count(faults), percent(count(faults), total)));
        text += &format!("  {name:<12} {exact:>27} {float:>27}: {meaning}\n");
    };
    of_tetrahedra("inverted", |faults| faults.inverted, "negative");
    of_tetrahedra("flat", |faults| faults.flat, "without a volume");
    of_tetrahedra("inside", |faults| faults.inside, "a vertex of a neighbour is inside of their sphere");
    of_tetrahedra("on", |faults| faults.on, "one is on it, and none inside, which is no violation");
    let Faults { concave, .. } = figures.exact;
    text +=
        &format!("  {:<12} {concave:>27} {:>27}: edges of the boundary\n", "concave", figures.float.concave);
    let mut line = |name: &str, count: u64, meaning: String| {
        text += &format!("  {name:<12} {count:>27}: {meaning}\n");
    };
    let Figures { interior_facets, boundary_facets, vertices, .. } = figures;
    line(
        "canonical",
        figures.not_canonical,
        format!("of {interior_facets} interior facets are not canonical"),
    );
    line("crowded", figures.crowded_facets, "uses of a facet that has a tetrahedron on that side".into());
    line("unused", figures.unused, format!("of {vertices} vertices are without a tetrahedron"));
    line(
        "torn",
        figures.torn_edges,
        format!("edges are not between two of {boundary_facets} boundary facets"),
    );
    line(
        "hull",
        u64::from(!figures.is_hull_proved),
        "1 unless the boundary is convex, closed, once around".into(),
    );
    text + &format!("  {:<12} {:>27}: vertices - edges + facets - tetrahedra\n", "euler", figures.euler)
}

/// One object. `share_not_delaunay` is that of the tetrahedra with a neighbour's vertex inside of their
/// sphere or on it, `share_not_positive` that of inverted and flat ones.
pub(super) fn json(figures: &Figures) -> Value {
    let faults = |faults: &Faults| {
        json!({
            "inverted": faults.inverted,
            "flat": faults.flat,
            "inside": faults.inside,
            "on": faults.on,
            "concave_edges": faults.concave,
            "share_not_delaunay": percent(faults.inside + faults.on, figures.tetrahedra) / 100.0,
            "share_not_positive": percent(faults.inverted + faults.flat, figures.tetrahedra) / 100.0,
        })
    };
    json!({
        "vertices": figures.vertices,
        "unused": figures.unused,
        "tetrahedra": figures.tetrahedra,
        "interior_facets": figures.interior_facets,
        "boundary_facets": figures.boundary_facets,
        "crowded_facets": figures.crowded_facets,
        "not_canonical": figures.not_canonical,
        "torn_edges": figures.torn_edges,
        "euler": figures.euler,
        "hull_proved": figures.is_hull_proved,
        "exact": faults(&figures.exact),
        "float": faults(&figures.float),
    })
}

/// 0 if there is nothing.
fn percent(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { 100.0 * part as f64 / whole as f64 }
}
