//! Actions of the panels that only the platform can carry out: files, clipboard, pictures, films.

use super::Segue;
use crate::platform;
use crate::render::is_stage_complete;
use crate::ui::{self, Action};
use eframe::egui;
use segue_session::Level;
use segue_session::export::file_name;
use segue_text::{Message, msg};

impl Segue {
    /// Warns once, before the first file is read, that the embedding page controls Segue through
    /// its API, and so can read the files.
    pub(super) fn warn_of_host(&mut self) {
        if self.panels.host_reads && !std::mem::replace(&mut self.has_warned_of_host, true) {
            self.session.say(Level::Warning, ui::HOST_READS);
        }
    }

    /// Carries out an action of the panels.
    pub(super) fn run_action(&mut self, action: &Action, ctx: &egui::Context) {
        match action {
            Action::OpenFiles => {
                self.warn_of_host();
                platform::open_files(&self.inbox);
            }
            Action::ChooseCorpus => platform::choose_corpus(&self.inbox),
            Action::OpenPage(address) => platform::open_page(address, ctx),
            Action::StopFetching(name) => self.stop_fetching(name),
            Action::StopLesson => self.stop_lessons(),
            Action::CopyLink => {
                self.copied = ui::LINK_COPIED;
                platform::copy_text(self.url_for_others(), ctx, &self.inbox);
            }
            Action::CopyLinkAsShown => {
                self.copied = ui::LINK_COPIED;
                platform::copy_text(self.url(), ctx, &self.inbox);
            }
            Action::Fullscreen(whole) => platform::set_fullscreen(*whole, ctx),
            Action::CopyText(text) => {
                self.copied = ui::TABLE_COPIED;
                platform::copy_text(text.clone(), ctx, &self.inbox);
            }
            Action::CopyReport => {
                if let Some(stage) = self.picture.stage_rect() {
                    platform::take_picture(stage, is_stage_complete, &self.inbox);
                }
            }
            Action::SaveText { name, mime, text } => {
                platform::download(name, mime, text.as_bytes(), &self.inbox);
            }
            Action::Save { which, how } => self.save_motion(which, how),
            Action::Convert(action) => self.run_conversion(action),
            Action::SavePicture => {
                if let Some(stage) = self.picture.stage_rect() {
                    platform::save_picture(
                        &file_name(&self.stage_name(), "png"),
                        stage,
                        is_stage_complete,
                        &self.inbox,
                    );
                }
            }
            Action::Record => match self.film.take() {
                Some(film) => film.save(&self.stage_name(), &self.inbox),
                None => {
                    if let Err(reason) = self.begin_film() {
                        self.session.say(
                            Level::Error,
                            msg!("The page could not be recorded: {reason}.", reason),
                        );
                    }
                }
            },
        }
    }

    /// Begins to film the page.
    pub(crate) fn begin_film(&mut self) -> Result<(), Message> {
        if self.film.is_some() {
            return Err("a recording is under way".into());
        }
        self.film = Some(platform::Film::begin()?);
        Ok(())
    }

    /// Ends the film under way.
    pub(crate) fn end_film(&mut self) -> Result<platform::Film, Message> {
        self.film.take().ok_or("no recording is under way".into())
    }
}
