//! Configurations of the library, as the audit holds them.

use spmesh_audit::configurations as audit;
use spmesh_geometry::configurations::{Configurations, Knots};

/// The same knots; the audit counts ranks itself.
pub fn knots(knots: &Knots) -> audit::Knots {
    audit::Knots::new(knots.points().to_vec()).expect("finite points")
}

/// The same configurations.
pub fn configurations(of: &Configurations) -> audit::Configurations {
    let mut held = audit::Configurations::new(of.degree(), of.claim());
    for group in of.groups() {
        for boundaries in [group.triangles, group.infinite].into_iter().filter(|all| !all.is_empty()) {
            held.extend(group.interior, boundaries).expect("few configurations");
        }
    }
    held
}
