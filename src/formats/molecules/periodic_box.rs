//! Periodic boxes: the cell that a simulation or a crystal repeats in all directions.

use std::fmt;
use std::str::FromStr;

use spmesh_base::error::{Error, Result};

/// Least volume of a box, in the product of the lengths of its vectors.
const FLATTEST: f64 = 1e-6;

/// Least and greatest length of a vector: products of three squares stay finite.
const SHORTEST: f64 = 1e-30;
const LONGEST: f64 = 1e30;

/// A periodic box: three vectors that span a parallelepiped, which is repeated in all directions.
///
/// The vectors may have any direction and either orientation. They are finite, and neither absurdly long or
/// short nor nearly in a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeriodicBox {
    vectors: [[f64; 3]; 3],
}

/// The box that a file states of a model or a frame, or why that cannot be used; `None` if it states none.
pub type StatedBox = Option<std::result::Result<PeriodicBox, String>>;

impl PeriodicBox {
    /// The box of three vectors, each in x, y and z, in Å.
    ///
    /// # Errors
    /// Malformed, if a number is not finite, a length is not between 1e-30 and 1e30, or the volume is below a
    /// millionth of the product of the lengths.
    pub fn new(vectors: [[f64; 3]; 3]) -> Result<PeriodicBox> {
        let found = PeriodicBox { vectors };
        if let Some(number) = vectors.as_flattened().iter().find(|number| !number.is_finite()) {
            return Err(Error::malformed(format!("a box with the number {number}, expected finite ones")));
        }
        let lengths = found.lengths();
        if let Some(length) = lengths.iter().find(|length| !(SHORTEST..=LONGEST).contains(*length)) {
            let message = format!("a box with a side of {length:e}, expected {SHORTEST:e} to {LONGEST:e}");
            return Err(Error::malformed(message));
        }
        if found.volume() < FLATTEST * lengths.iter().product::<f64>() {
            let message = "the vectors of the box are nearly in a plane, so that it has no volume";
            return Err(Error::malformed(message));
        }
        Ok(found)
    }

    /// The box with the sides a, b, c (Å) and the angles alpha (between b and c), beta (a and c) and gamma (a
    /// and b) in degrees: a along x, and b in the plane of x and y with y positive.
    ///
    /// # Errors
    /// As [`PeriodicBox::new`]; malformed, if no box has these angles.
    pub fn from_sides([a, b, c]: [f64; 3], degrees: [f64; 3]) -> Result<PeriodicBox> {
        if let Some(side) = [a, b, c].into_iter().find(|side| !side.is_finite() || *side <= 0.0) {
            return Err(Error::malformed(format!("a box with a side of {side}, expected a positive length")));
        }
        let is_angle = |degrees: &f64| *degrees > 0.0 && *degrees < 180.0;
        if let Some(angle) = degrees.iter().find(|angle| !is_angle(angle)) {
            return Err(Error::malformed(format!("a box with the angle {angle}, expected 0 to 180 degrees")));
        }
        let [alpha, beta, gamma] = degrees.map(cosine);
        let sine = ((1.0 - gamma) * (1.0 + gamma)).sqrt();
        let y = (alpha - beta * gamma) / sine;
        let square = (1.0 - beta) * (1.0 + beta) - y * y;
        if square.is_nan() || square <= 0.0 {
            let [alpha, beta, gamma] = degrees;
            return Err(Error::malformed(format!("no box has the angles {alpha}, {beta} and {gamma}")));
        }
        PeriodicBox::new([[a, 0.0, 0.0], [b * gamma, b * sine, 0.0], [c * beta, c * y, c * square.sqrt()]])
    }

    /// The box of the sides and angles that a structure states of its unit cell. `None` if they stand for
    /// none: structures without crystals have a cell of 1 Å, and simulations without a box one of zero.
    pub(crate) fn of_unit_cell([a, b, c, degrees @ ..]: [f64; 6]) -> Option<Result<PeriodicBox>> {
        let is_none = [[0.0; 3], [1.0; 3]].contains(&[a, b, c]);
        (!is_none).then(|| PeriodicBox::from_sides([a, b, c], degrees))
    }

    /// The box of three vectors that a file states. `None` if these are zero, which stands for none.
    pub(crate) fn of_vectors(vectors: [[f64; 3]; 3]) -> Option<Result<PeriodicBox>> {
        (vectors != [[0.0; 3]; 3]).then(|| PeriodicBox::new(vectors))
    }

    /// As [`PeriodicBox::of_vectors`], of the nine numbers of a trajectory in nm.
    pub(crate) fn of_nanometres(numbers: &[f64]) -> Option<Result<PeriodicBox>> {
        let vectors = numbers.as_chunks::<3>().0.first_chunk::<3>()?;
        PeriodicBox::of_vectors(vectors.map(|vector| vector.map(|length| 10.0 * length)))
    }

    /// The box of the numbers of a text: three sides, or three sides and three angles in degrees, or three
    /// vectors.
    ///
    /// # Errors
    /// As [`PeriodicBox::from_sides`]; malformed, if there is another count of numbers.
    pub fn from_numbers(numbers: &[f64]) -> Result<PeriodicBox> {
        match *numbers {
            [a, b, c] => PeriodicBox::from_sides([a, b, c], [90.0; 3]),
            [a, b, c, alpha, beta, gamma] => PeriodicBox::from_sides([a, b, c], [alpha, beta, gamma]),
            [ax, ay, az, bx, by, bz, cx, cy, cz] => {
                PeriodicBox::new([[ax, ay, az], [bx, by, bz], [cx, cy, cz]])
            }
            _ => {
                let count = numbers.len();
                let expected = "3 sides, 3 sides and 3 angles, or 9 numbers of 3 vectors";
                Err(Error::malformed(format!("a box of {count} numbers, expected {expected}")))
            }
        }
    }

    /// The vectors, in Å.
    pub fn vectors(&self) -> [[f64; 3]; 3] {
        self.vectors
    }

    /// The lengths of the vectors, in Å.
    pub fn lengths(&self) -> [f64; 3] {
        self.vectors.map(|[x, y, z]| x.hypot(y).hypot(z))
    }

    /// The volume, in Å³; positive for either orientation.
    pub fn volume(&self) -> f64 {
        let [[ax, ay, az], [bx, by, bz], [cx, cy, cz]] = self.vectors;
        (ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)).abs()
    }
}

/// The cosine of an angle in degrees. Angles of usual cells have exact ones, so that their lattices stay
/// regular.
fn cosine(degrees: f64) -> f64 {
    match degrees {
        60.0 => 0.5,
        90.0 => 0.0,
        120.0 => -0.5,
        _ => degrees.to_radians().cos(),
    }
}

/// Numbers with commas between them, as [`PeriodicBox::from_numbers`] takes them.
impl FromStr for PeriodicBox {
    type Err = Error;

    fn from_str(text: &str) -> Result<PeriodicBox> {
        let parse = |field: &str| {
            let field = field.trim();
            field.parse().map_err(|_| Error::malformed(format!("{field:?} in the box is no number")))
        };
        PeriodicBox::from_numbers(&text.split(',').map(parse).collect::<Result<Vec<f64>>>()?)
    }
}

/// Its vectors, as [`PeriodicBox::from_str`] reads them.
impl fmt::Display for PeriodicBox {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let numbers = self.vectors.as_flattened().iter().map(f64::to_string);
        f.write_str(&numbers.collect::<Vec<_>>().join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::molecules::{Structure, read_structure_from};

    #[test]
    fn sides_and_angles_make_vectors() {
        let found: PeriodicBox = "10,20,30".parse().unwrap();
        assert_eq!(found.vectors(), [[10.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 30.0]]);
        let found = PeriodicBox::from_sides([3.0, 4.0, 5.0], [80.0, 95.0, 110.0]).unwrap();
        let [a, b, c] = found.vectors();
        let cosine = |p: [f64; 3], q: [f64; 3]| {
            let dot = |p: [f64; 3], q: [f64; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
            dot(p, q) / (dot(p, p) * dot(q, q)).sqrt()
        };
        for (pair, degrees) in [((b, c), 80.0f64), ((a, c), 95.0), ((a, b), 110.0)] {
            assert!((cosine(pair.0, pair.1) - degrees.to_radians().cos()).abs() < 1e-15);
        }
        found.lengths().iter().zip([3.0, 4.0, 5.0]).for_each(|(l, m)| assert!((l - m).abs() < 1e-14));
        assert_eq!(found.to_string().parse::<PeriodicBox>().unwrap(), found);
        // Left-handed vectors span the same lattice.
        let turned = PeriodicBox::new([b, a, c]).unwrap();
        assert_eq!(turned.volume(), found.volume());
    }

    #[test]
    fn what_is_no_box_is_refused() {
        for (text, reason) in [
            ("10,20", "2 numbers"),
            ("10,20,x", "\"x\""),
            ("", "\"\""),
            ("10,20,nan", "NaN"),
            ("10,20,inf", "inf"),
            ("10,20,0", "side of 0"),
            ("10,20,-3", "side of -3"),
            ("10,20,30,90,90,180", "angle 180"),
            ("10,20,30,90,NaN,90", "angle NaN"),
            ("10,20,30,60,60,150", "no box has the angles"),
            ("10,20,30,90,90,1e-5", "in a plane"),
            ("10,20,30,90,90,1e-9", "no box has the angles"),
            ("1,0,0,0,1,0,1,1,0", "in a plane"),
            ("1e300,1,1", "side of 1e300"),
        ] {
            let error = text.parse::<PeriodicBox>().unwrap_err().to_string();
            assert!(error.contains(reason), "{text}: {error}");
        }
    }

    fn stated(text: &'static str) -> Structure {
        read_structure_from(text.as_bytes(), "input", None).unwrap()
    }

    fn box_of(structure: &Structure) -> std::result::Result<PeriodicBox, String> {
        structure.models[0].periodic_box.clone().unwrap()
    }

    #[test]
    fn structures_state_their_boxes() {
        let atom = "ATOM      1  N   LYS A   1      35.365  22.342 -11.980  1.00 22.28           N\n";
        let with = |record: &str| {
            let text: &'static str = format!("{record}\n{atom}").leak();
            stated(text)
        };
        let pdb = with("CRYST1   59.062   68.451   30.517  90.00  90.00  90.00 P 21 21 21    4");
        let vectors = box_of(&pdb).unwrap().vectors();
        assert_eq!([vectors[0][0], vectors[1][1], vectors[2][2]], [59.062, 68.451, 30.517]);
        assert_eq!(pdb.space_group.as_deref(), Some("P 21 21 21"));
        let plain = with("CRYST1   20.000   20.000   20.000  90.00  90.00  60.00 P 1           1");
        assert_eq!(plain.space_group, None);
        assert!(plain.models[0].periodic_box.as_ref().unwrap().is_ok());
        for none in ["    1.000    1.000    1.000", "    0.000    0.000    0.000"] {
            let without = with(&format!("CRYST1{none}  90.00  90.00  90.00 P 1           1"));
            assert_eq!(without.models[0].periodic_box, None);
        }
        let damaged = with("CRYST1   20.000   2x.000   20.000  90.00  90.00  90.00 P 1           1");
        assert!(box_of(&damaged).unwrap_err().contains("line 1"));
        let cif = stated(
            "data_x\n_cell.length_a 10.5(2)\n_cell.length_b 20\n_cell.length_c 30\n_cell.angle_alpha 90\n\
             _cell.angle_beta 90\n_cell.angle_gamma 120\n_symmetry.space_group_name_H-M 'P 61'\nloop_\n\
             _atom_site.Cartn_x\n_atom_site.Cartn_y\n_atom_site.Cartn_z\n1 2 3\n",
        );
        assert_eq!(box_of(&cif).unwrap().lengths()[0], 10.5);
        assert_eq!(cif.space_group.as_deref(), Some("P 61"));
    }

    #[test]
    fn each_frame_has_its_own_box() {
        let frames = stated(
            "1\nLattice=\"5 0 0 1 6 0 0 2 7\" pbc=\"T T T\"\nC 0 0 0\n1\nno box\nC 0 0 0\n\
             1\nlattice=\"5 0 0 1 6 0 0 2 7\" pbc=\"T T F\"\nC 0 0 0\n1\nLattice=\"5 0 0\"\nC 0 0 0\n",
        );
        let boxes: Vec<_> = frames.models.into_iter().map(|model| model.periodic_box).collect();
        let [Some(Ok(first)), None, Some(Err(flat)), Some(Err(short))] = &boxes[..] else {
            panic!("{boxes:?}");
        };
        assert_eq!(first.vectors(), [[5.0, 0.0, 0.0], [1.0, 6.0, 0.0], [0.0, 2.0, 7.0]]);
        assert!(flat.contains("line 8") && flat.contains("pbc"), "{flat}");
        assert!(short.contains("line 11") && short.contains("nine numbers"), "{short}");
    }
}
