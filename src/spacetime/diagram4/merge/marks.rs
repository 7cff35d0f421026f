//! A set of numbers that is cleared in constant time.

pub(super) struct Marks {
    round: u32,
    rounds: Vec<u32>,
}

impl Marks {
    /// An empty set of numbers below a limit.
    pub(super) fn new(numbers: usize) -> Marks {
        Marks { round: 1, rounds: vec![0; numbers] }
    }

    #[inline(always)]
    pub(super) fn clear(&mut self) {
        self.round = self.round.wrapping_add(1);
        if self.round == 0 {
            self.rounds.fill(0);
            self.round = 1;
        }
    }

    /// Whether the number had no mark before.
    #[inline(always)]
    pub(super) fn mark(&mut self, number: u32) -> bool {
        std::mem::replace(&mut self.rounds[number as usize], self.round) != self.round
    }
}
