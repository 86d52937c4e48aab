//! Integrates one motion with either form of the contact equations (with or without charts).

use palpate_geometry::{Shape, Surface, Visitor};

use crate::chart::ChartForm;
use crate::chart_free::{ChartFree, OF_GRAPHS, OF_SPACE};
use crate::contact_equations::ContactEquations;
use crate::error::RollError;
use crate::integrator::{Dop853, Integrated, Rk4, Stopped, System};
use crate::roller::Bodies;
use crate::{Chart, Contact, Motion};

#[derive(Clone, Copy, Debug)]
pub(crate) enum Method {
    Rk4(Rk4),
    Dop853(Dop853),
}

/// An integrator, and the form of the contact equations that it integrates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Integration {
    pub(crate) method: Method,
    pub(crate) chart: Chart,
}

impl Integration {
    /// The contact at the end of `motion`, and the number of evaluations of the contact equations.
    pub(crate) fn advance(
        &self,
        bodies: &Bodies<'_, Shape>,
        from: &Contact,
        motion: &Motion,
    ) -> Result<(Contact, usize), RollError> {
        self.in_unit_time(bodies, from, &motion.in_unit_time())
            .map_err(|error| RollError {
                time_s: error.time_s * motion.duration_s,
                ..error
            })
    }

    fn in_unit_time(
        &self,
        bodies: &Bodies<'_, Shape>,
        from: &Contact,
        motion: &Motion,
    ) -> Result<(Contact, usize), RollError> {
        match self.chart {
            Chart::Free => bodies.object.visited_by(Free {
                integration: self,
                bodies,
                from,
                motion,
            }),
            Chart::Montana(held) => {
                let (form, start) = ChartForm::new(bodies, from, motion, held)
                    .map_err(|fault| RollError::new(fault, 0.0, from.on_object))?;
                self.follow(bodies, &form, start, from, motion)
            }
        }
    }

    fn free<S: Surface, const READ: usize>(
        &self,
        bodies: &Bodies<'_, S>,
        from: &Contact,
        motion: &Motion,
    ) -> Result<(Contact, usize), RollError> {
        let (form, start) = ChartFree::<S, READ>::new(bodies, from, motion);
        self.follow(bodies, &form, start, from, motion)
    }

    fn follow<S: Surface, const N: usize>(
        &self,
        bodies: &Bodies<'_, S>,
        form: &impl ContactEquations<N>,
        start: [f64; N],
        from: &Contact,
        motion: &Motion,
    ) -> Result<(Contact, usize), RollError> {
        let error = |fault, time_s, state: &[f64; N]| {
            let place = form.place(state).unwrap_or(from.on_object);
            RollError::new(fault, time_s, place)
        };
        let Integrated { state, evaluations } = self
            .method
            .integrate(form, start, motion.duration_s)
            .map_err(|stopped| {
                let fault = bodies.cause(stopped.fault, form.contact(&stopped.state));
                error(fault, stopped.time_s, &stopped.state)
            })?;
        palpate_statistics::work::derived(evaluations as u64);
        let contact = form
            .contact(&state)
            .map_err(|fault| error(fault, motion.duration_s, &state))?;
        Ok((contact, evaluations))
    }
}

/// One motion that is integrated with the chart-free equations. The code is compiled separately for each type of
/// surface.
struct Free<'a> {
    integration: &'a Integration,
    bodies: &'a Bodies<'a, Shape>,
    from: &'a Contact,
    motion: &'a Motion,
}

impl Visitor for Free<'_> {
    type Out = Result<(Contact, usize), RollError>;

    #[inline]
    fn visit<S: Surface>(self, surface: &S) -> Self::Out {
        let bodies = self.bodies.with(surface);
        match S::IS_GRAPH {
            true => (self.integration).free::<S, OF_GRAPHS>(&bodies, self.from, self.motion),
            false => (self.integration).free::<S, OF_SPACE>(&bodies, self.from, self.motion),
        }
    }
}

impl Method {
    #[inline]
    fn integrate<const N: usize>(
        &self,
        system: &impl System<N>,
        state: [f64; N],
        duration_s: f64,
    ) -> Result<Integrated<N>, Box<Stopped<N>>> {
        match self {
            Self::Rk4(method) => method.integrate(system, state, duration_s),
            Self::Dop853(method) => method.integrate(system, state, duration_s),
        }
    }
}
