//! The memory that the page has for the library.

use super::{Loaded, Session};
use crate::memory::{Memory, MemoryUse, PageMemory, expected_bytes, library_bytes, refusal};
use crate::motion::FeetReader;
use crate::reading::ReadTask;
use segue_text::Message;

impl Session {
    /// Takes what the page says of its memory. Once more than half of it is taken, motion that only
    /// steps back hold is let go: it is read again when it comes back.
    pub fn note_memory(&mut self, page: PageMemory) {
        let memory = Memory::follow(self.memory, page, library_bytes(&self.document.library));
        self.memory = Some(memory);
        // Once for every change: there may be many steps of many clips.
        if memory.is_scarce()
            && self.let_go_at.replace(self.document.library_revision)
                != Some(self.document.library_revision)
            && self.document.history.let_go_of_motions_outside(&self.document.library)
        {
            self.feet = FeetReader::default();
        }
    }

    /// How much memory is in use; `None` where there is as much as anybody needs.
    #[must_use]
    pub fn memory(&self) -> Option<MemoryUse> {
        self.memory.as_ref().map(Memory::in_use)
    }

    /// How much memory a task's file is expected to need, bytes, where that is more than is left.
    #[must_use]
    pub fn memory_lacking_for(&self, task: &ReadTask) -> Option<u64> {
        let needed = expected_bytes(&task.name, task.size);
        self.memory().is_some_and(|memory| needed > memory.left()).then_some(needed)
    }

    /// Ends a task because there is no memory for the `needed` bytes of its clips. `None` where
    /// nobody waits for it any longer.
    pub fn refuse_for_memory(&mut self, task: u64, needed: u64) -> Option<Result<Loaded, Message>> {
        let (name, size) = self.file_of_task(task)?;
        let memory = self.memory().unwrap_or(MemoryUse { used: 0, limit: 0 });
        let text = refusal(name, size, needed, memory, &self.document.library);
        self.fail_reading(task, text.clone(), text)
    }
}
