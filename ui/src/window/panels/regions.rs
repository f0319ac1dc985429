//! The regions of the window, between which F6 moves the focus, and their names and roles for
//! screen readers.

use egui::{Context, Id, Rect, Response, Role, Sense, Ui, WidgetInfo};

/// A region of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "Region::name() says what each is")]
pub enum Region {
    Menu,
    Toolbar,
    Viewport,
    Tabs,
    Panel,
    Figures,
    Legend,
    Dialog,
    Messages,
}

impl Region {
    /// All regions, in the order in which F6 visits them.
    pub const ALL: [Self; 9] = [
        Self::Menu,
        Self::Toolbar,
        Self::Viewport,
        Self::Tabs,
        Self::Panel,
        Self::Figures,
        Self::Legend,
        Self::Dialog,
        Self::Messages,
    ];

    /// Name of the region as a screen reader says it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Menu => "Menu bar",
            Self::Toolbar => "Toolbar",
            Self::Viewport => "3D viewport",
            Self::Tabs => "Tabs",
            Self::Panel => "Side panel",
            Self::Figures => "Figures",
            Self::Legend => "Legend",
            Self::Dialog => "Dialog",
            Self::Messages => "Messages",
        }
    }

    fn role(self) -> Role {
        match self {
            Self::Menu => Role::MenuBar,
            Self::Toolbar => Role::Toolbar,
            Self::Viewport => Role::Image,
            Self::Tabs => Role::TabList,
            Self::Panel => Role::TabPanel,
            Self::Figures => Role::Status,
            Self::Legend => Role::Legend,
            Self::Dialog => Role::Dialog,
            Self::Messages => Role::Log,
        }
    }
}

/// Where a region is, and the control of it that gets the focus.
#[derive(Clone, Copy, Debug)]
struct Place {
    first: Id,
    rect: Rect,
    /// Update in which the region was drawn last.
    pass: u64,
}

/// The places of all regions, as they were drawn last.
#[derive(Clone, Debug, Default)]
struct Places([Option<Place>; Region::ALL.len()]);

fn places_id() -> Id {
    Id::unique("regions")
}

/// Gives the contents of `ui` the name and the role of a region.
pub fn name(ui: &Ui, region: Region) {
    ui.ctx().accesskit_node_builder(ui.unique_id(), |node| {
        node.set_role(region.role());
        node.set_label(region.name());
    });
}

/// Notes a control of a region that may get the focus. The first one that is noted in an update
/// counts; the place of the region grows by all.
pub fn note(control: &Response, region: Region) {
    let ctx = &control.ctx;
    let pass = ctx.cumulative_pass_nr();
    let (id, rect) = (control.id, control.rect);
    ctx.data_mut(|data| {
        let places = data.get_temp_mut_or_default::<Places>(places_id());
        let place = &mut places.0[region as usize];
        *place = Some(match *place {
            Some(Place { first, rect: before, pass: last }) if last == pass => {
                Place { first, rect: before.union(rect), pass }
            }
            _ => Place { first: id, rect, pass },
        });
    });
}

/// Notes the whole rectangle of a region that has a control.
pub fn note_rect(ctx: &Context, region: Region, rect: Rect) {
    ctx.data_mut(|data| {
        let places = data.get_temp_mut_or_default::<Places>(places_id());
        if let Some(place) = &mut places.0[region as usize] {
            place.rect = rect;
        }
    });
}

/// Makes a rectangle of texts a region that gets the focus, so that a screen reader reads `text`.
pub fn readable(ui: &Ui, region: Region, rect: Rect, text: &str) {
    let response = ui.interact(rect, Id::unique(region.name()), Sense::focusable_noninteractive());
    response.widget_info(|| WidgetInfo::labeled(region.role(), true, format!("{}: {text}", region.name())));
    note(&response, region);
}

/// Moves the focus to the next region that is shown, or to the one before.
pub fn move_focus(ctx: &Context, forward: bool) {
    let (places, now) = (ctx.data(|data| data.get_temp::<Places>(places_id())), ctx.cumulative_pass_nr());
    let Some(Places(places)) = places else { return };
    let shown = |region: &Region| places[*region as usize].filter(|place| now <= place.pass + 1);
    let order: Vec<Region> = Region::ALL.into_iter().filter(|region| shown(region).is_some()).collect();
    let focused = ctx.memory(|memory| memory.focused()).and_then(|id| ctx.read_response(id));
    let holds = |region: &&Region| {
        let place = shown(region);
        place.zip(focused.as_ref()).is_some_and(|(place, focused)| {
            place.first == focused.id || place.rect.contains(focused.rect.center())
        })
    };
    // Over the viewport lie other regions, which come after it. Without a focus, the viewport has
    // the keys.
    let current = order.iter().rev().find(holds).copied().unwrap_or(Region::Viewport);
    let at = order.iter().position(|region| *region == current).unwrap_or(0);
    let step = if forward { 1 } else { order.len().saturating_sub(1) };
    let next = order.get((at + step) % order.len().max(1)).and_then(shown);
    if let Some(next) = next {
        ctx.memory_mut(|memory| memory.request_focus(next.first));
    }
}
