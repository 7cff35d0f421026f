//! Meshes as data of serde: their points, and their simplices by indices of points.

use crate::constrained2::ConstrainedTriangulation;
use crate::delaunay2::Triangulation;
use crate::delaunay3::Tetrahedralization;
use serde::ser::{Serialize, SerializeStruct, Serializer};

impl Serialize for Triangulation {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut mesh = serializer.serialize_struct("Triangulation", 2)?;
        mesh.serialize_field("points", self.points())?;
        mesh.serialize_field("simplices", &self.simplices().collect::<Vec<_>>())?;
        mesh.end()
    }
}

impl Serialize for ConstrainedTriangulation {
    /// With the constrained edges and their segments.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut mesh = serializer.serialize_struct("ConstrainedTriangulation", 3)?;
        mesh.serialize_field("points", self.points())?;
        mesh.serialize_field("simplices", &self.simplices().collect::<Vec<_>>())?;
        mesh.serialize_field("constrained_edges", &self.constrained_edges().collect::<Vec<_>>())?;
        mesh.end()
    }
}

impl Serialize for Tetrahedralization {
    /// Without points: duplicates are not kept.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut mesh = serializer.serialize_struct("Tetrahedralization", 2)?;
        mesh.serialize_field("simplices", &self.simplices().collect::<Vec<_>>())?;
        mesh.serialize_field("duplicates", &self.duplicates)?;
        mesh.end()
    }
}

#[cfg(test)]
mod tests {
    use crate::constrained2::ConstrainedTriangulation;
    use crate::{Error, Location, delaunay2, delaunay3};
    use serde_json::{json, to_value};

    #[test]
    fn results_and_errors_are_data() {
        let plane = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let mesh = ConstrainedTriangulation::new(&plane, &[[1, 0]]).unwrap();
        let simplices: Vec<[u32; 3]> = mesh.simplices().collect();
        let expected = json!({ "points": plane, "simplices": simplices, "constrained_edges": [[[0, 1], 0]] });
        assert_eq!(to_value(&mesh).unwrap(), expected);
        let mesh = delaunay2::triangulate(&plane).unwrap();
        assert_eq!(to_value(&mesh).unwrap()["points"], json!(plane));
        let space = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]];
        let mesh = delaunay3::triangulate(&space).unwrap();
        assert_eq!(to_value(&mesh).unwrap()["duplicates"], json!([[4, 0]]));
        let location = Location::Edge([1, 2]);
        let text = serde_json::to_string(&location).unwrap();
        assert_eq!(serde_json::from_str::<Location>(&text).unwrap(), location);
        let error = to_value(Error::NoSuchPoint { segment: 1, ends: [0, 9] }).unwrap();
        assert_eq!(error, json!({ "NoSuchPoint": { "segment": 1, "ends": [0, 9] } }));
    }
}
