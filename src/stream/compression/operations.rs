//! What triangles are coded with: an operation each, which says how its vertices are given.

use super::Fault;

/// Operations of triangles that share no edge with an earlier one: three digits of base 3.
const LOOSE: u8 = 27;
/// Operations of attached triangles follow: near or not, apex, edge, rotation.
const APEXES: u8 = 7;
const END: u8 = LOOSE + 2 * APEXES * 3 * 3;

/// How a vertex is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Given {
    /// The next new vertex.
    Next,
    /// A new vertex, by a number of the column of references.
    Reference,
    /// An imported vertex, by a number of the column of imports.
    Import,
}

impl Given {
    /// What the digits 0, 1 and 2 stand for.
    pub(super) const ALL: [Given; 3] = [Given::Next, Given::Reference, Given::Import];
}

/// How the third vertex of an attached triangle is given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Apex {
    Given(Given),
    /// The end of an open edge that leaves the first vertex: the newest one, or the one before.
    LeavesFirst(usize),
    /// The start of an open edge that reaches the second vertex.
    ReachesSecond(usize),
}

const APEX: [Apex; APEXES as usize] = [
    Apex::Given(Given::Next),
    Apex::Given(Given::Reference),
    Apex::Given(Given::Import),
    Apex::LeavesFirst(0),
    Apex::ReachesSecond(0),
    Apex::LeavesFirst(1),
    Apex::ReachesSecond(1),
];

/// The operation of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operation {
    /// Three vertices.
    Loose([Given; 3]),
    /// On the other side of an edge of an earlier triangle.
    Attached {
        /// Whether that is the triangle before.
        is_near: bool,
        apex: Apex,
        /// The edge of that triangle, by its first vertex.
        edge: u8,
        /// The place of the shared edge in this triangle, by its first vertex.
        rotation: u8,
    },
}

impl Operation {
    /// The token for the operation.
    pub(super) fn code(self) -> u8 {
        match self {
            Operation::Loose(given) => given.into_iter().fold(0, |code, given| 3 * code + given as u8),
            Operation::Attached { is_near, apex, edge, rotation } => {
                let apex = APEX.iter().position(|&of| of == apex).expect("all are in the table") as u8;
                LOOSE + ((u8::from(is_near) * APEXES + apex) * 3 + edge) * 3 + rotation
            }
        }
    }

    /// The operation of a token.
    pub(super) fn of_code(code: u8) -> Result<Operation, Fault> {
        if code < LOOSE {
            let given = [code / 9, code / 3 % 3, code % 3];
            return Ok(Operation::Loose(given.map(|digit| Given::ALL[usize::from(digit)])));
        }
        if code >= END {
            return Err("an operation above 152");
        }
        let code = code - LOOSE;
        Ok(Operation::Attached {
            is_near: code / 9 / APEXES == 1,
            apex: APEX[usize::from(code / 9 % APEXES)],
            edge: code / 3 % 3,
            rotation: code % 3,
        })
    }

    /// How many numbers the operation takes of the columns of distances, references and imports.
    pub(super) fn takes(self) -> [usize; 3] {
        let mut takes = [0; 3];
        let mut take = |given: Given| match given {
            Given::Next => {}
            Given::Reference => takes[1] += 1,
            Given::Import => takes[2] += 1,
        };
        match self {
            Operation::Loose(given) => given.into_iter().for_each(take),
            Operation::Attached { is_near, apex, .. } => {
                if let Apex::Given(given) = apex {
                    take(given);
                }
                takes[0] = usize::from(!is_near);
            }
        }
        takes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_those_of_the_format() {
        for code in 0..END {
            assert_eq!(Operation::of_code(code).unwrap().code(), code);
        }
        for code in END..=u8::MAX {
            Operation::of_code(code).unwrap_err();
        }
        let near = Operation::Attached { is_near: true, apex: Apex::LeavesFirst(1), edge: 2, rotation: 1 };
        assert_eq!(near.code(), 27 + ((7 + 5) * 3 + 2) * 3 + 1);
        assert_eq!(near.takes(), [0, 0, 0]);
        let loose = Operation::Loose([Given::Import, Given::Next, Given::Import]);
        assert_eq!((loose.code(), loose.takes()), (20, [0, 0, 2]));
    }
}
