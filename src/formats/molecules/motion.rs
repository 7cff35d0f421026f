//! Motions of atoms: a matrix and a translation.

use spmesh_stream::model::points::Point3;

/// A motion: rows of a matrix, and a translation in world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    pub(crate) rows: [[f64; 3]; 3],
    pub(crate) translation: [f64; 3],
}

impl Motion {
    /// The motion of twelve numbers in texts: each row of the matrix with its part of the translation. `None`
    /// if one is not a finite number.
    pub(crate) fn parse(texts: &[impl AsRef<str>]) -> Option<Motion> {
        let numbers = texts.iter().map(|text| text.as_ref().parse().ok().filter(|n: &f64| n.is_finite()));
        let numbers: Vec<f64> = numbers.collect::<Option<_>>()?;
        let [a, b, c] = <[[f64; 4]; 3]>::try_from(numbers.as_chunks().0).ok()?;
        let rows = [a, b, c].map(|[x, y, z, _]| [x, y, z]);
        Some(Motion { rows, translation: [a[3], b[3], c[3]] })
    }

    /// The motion that does `first` and then this.
    pub(crate) fn after(&self, first: &Motion) -> Motion {
        let column = |column: usize| [0, 1, 2].map(|row| first.rows[row][column]);
        let columns = [0, 1, 2].map(column);
        let rows = self.rows.map(|row| columns.map(|column| dot(row, column)));
        Motion { rows, translation: self.apply(first.translation, 1.0) }
    }

    /// The moved point, both in steps of `scale` world units.
    pub(crate) fn apply(&self, point: Point3, scale: f64) -> Point3 {
        [0, 1, 2].map(|axis| dot(self.rows[axis], point) + self.translation[axis] / scale)
    }

    /// The numbers as bits, by which equal motions are found. Zeros lose their sign.
    pub(crate) fn key(&self) -> [u64; 12] {
        let [a, b, c] = self.rows;
        let numbers = [a, b, c, self.translation];
        std::array::from_fn(|i| (numbers[i / 3][i % 3] + 0.0).to_bits())
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
