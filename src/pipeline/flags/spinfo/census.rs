//! What `spinfo --count-violations` prints.

use serde_json::{Value, json};

use spmesh_audit::{Counts, Faults};

/// A line per kind of fault. Faults that arithmetic finds are counted twice, exactly and in plain floating
/// point, each count with its share of the tetrahedra.
pub(super) fn text(counts: &Counts) -> String {
    let total = counts.tetrahedra;
    let mut text =
        format!("violations among {total} tetrahedra {:>20} {:>27}\n", "exactly", "in floating point");
    let mut of_tetrahedra = |name: &str, count: fn(&Faults) -> u64, meaning: &str| {
        let [exact, float] = [&counts.exact, &counts.float]
            .map(|faults| format!("{} ({:.4} %)", count(faults), percent(count(faults), total)));
        text += &format!("  {name:<12} {exact:>27} {float:>27}: {meaning}\n");
    };
    of_tetrahedra("inverted", |faults| faults.inverted, "negative");
    of_tetrahedra("flat", |faults| faults.flat, "without a volume");
    of_tetrahedra("inside", |faults| faults.inside, "a vertex of a neighbour is inside of their sphere");
    of_tetrahedra("on", |faults| faults.on, "one is on it, and none inside, which is no violation");
    let Faults { concave, .. } = counts.exact;
    text +=
        &format!("  {:<12} {concave:>27} {:>27}: edges of the boundary\n", "concave", counts.float.concave);
    let mut line = |name: &str, count: u64, meaning: String| {
        text += &format!("  {name:<12} {count:>27}: {meaning}\n");
    };
    let Counts { interior_facets, boundary_facets, vertices, .. } = counts;
    line(
        "canonical",
        counts.not_canonical,
        format!("of {interior_facets} interior facets are not canonical"),
    );
    line("crowded", counts.crowded_facets, "uses of a facet that has a tetrahedron on that side".into());
    line("unused", counts.unused, format!("of {vertices} vertices are without a tetrahedron"));
    line(
        "torn",
        counts.torn_edges,
        format!("edges are not between two of {boundary_facets} boundary facets"),
    );
    line(
        "hull",
        u64::from(!counts.is_hull_proved),
        "1 unless the boundary is convex, closed, once around".into(),
    );
    text + &format!("  {:<12} {:>27}: vertices - edges + facets - tetrahedra\n", "euler", counts.euler)
}

/// One object. `share_not_delaunay` is the share of tetrahedra whose sphere has a neighbour's vertex inside
/// or on it; `share_not_positive` is the share of inverted and flat tetrahedra.
pub(super) fn json(counts: &Counts) -> Value {
    let faults = |faults: &Faults| {
        json!({
            "inverted": faults.inverted,
            "flat": faults.flat,
            "inside": faults.inside,
            "on": faults.on,
            "concave_edges": faults.concave,
            "share_not_delaunay": percent(faults.inside + faults.on, counts.tetrahedra) / 100.0,
            "share_not_positive": percent(faults.inverted + faults.flat, counts.tetrahedra) / 100.0,
        })
    };
    json!({
        "vertices": counts.vertices,
        "unused": counts.unused,
        "tetrahedra": counts.tetrahedra,
        "interior_facets": counts.interior_facets,
        "boundary_facets": counts.boundary_facets,
        "crowded_facets": counts.crowded_facets,
        "not_canonical": counts.not_canonical,
        "torn_edges": counts.torn_edges,
        "euler": counts.euler,
        "hull_proved": counts.is_hull_proved,
        "exact": faults(&counts.exact),
        "float": faults(&counts.float),
    })
}

/// `part` as a percentage of `whole`; 0 if `whole` is 0.
fn percent(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { 100.0 * part as f64 / whole as f64 }
}
