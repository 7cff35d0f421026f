//! Conversion of the library's configurations to the types of the audit.

use spmesh_audit::configurations as audit;
use spmesh_configurations::{Configurations, Knots};

/// The knots as the audit holds them; it computes their ranks itself.
pub fn knots(knots: &Knots) -> audit::Knots {
    audit::Knots::new(knots.points().to_vec()).expect("finite points")
}

/// The configurations as the audit holds them.
pub fn configurations(of: &Configurations) -> audit::Configurations {
    let mut held = audit::Configurations::new(of.degree(), of.claim());
    for group in of.groups() {
        for boundaries in [group.triangles, group.infinite].into_iter().filter(|all| !all.is_empty()) {
            held.extend(group.interior, boundaries).expect("few configurations");
        }
    }
    held
}
