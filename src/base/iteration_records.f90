!> Records of Newton iterations and increments, for console output, .sta, .cvg and the result file.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_iteration_records
  use amontons_kinds, only: DP
  use amontons_failure, only: failure_type
  implicit none
  private
  public :: iteration_record_type, increment_record_type
  public :: REPORT_LINE_LENGTH
  public :: PHASE_READING, PHASE_MODEL, PHASE_PLANNING, PHASE_ASSEMBLY, PHASE_CONTACT, PHASE_FACTOR, PHASE_KRYLOV, PHASE_OUTPUT, &
    PHASE_OTHER, N_PHASES, PHASE_NAMES

  !> Phases of a job: reading the deck; setting up and checking the model; patterns, numbering and the choice of the solver; the
  !! bulk; contact; factors and preconditioners; directions; result files; all else.
  integer, parameter :: PHASE_READING = 1, PHASE_MODEL = 2, PHASE_PLANNING = 3, PHASE_ASSEMBLY = 4, PHASE_CONTACT = 5, &
    PHASE_FACTOR = 6, PHASE_KRYLOV = 7, PHASE_OUTPUT = 8, PHASE_OTHER = 9, N_PHASES = 9
  character(12), parameter :: PHASE_NAMES(N_PHASES) = [character(12) :: 'reading', 'model', 'planning', 'assembly', 'contact', &
    'factor', 'krylov', 'output', 'other']

  integer, parameter :: REPORT_LINE_LENGTH = 160     !< of a line of a failure report

  !> One Newton iteration (a row of .cvg).
  type :: iteration_record_type
    integer :: step = 0, increment = 0, attempt = 0, iteration = 0
    integer :: n_closed = 0                    !< slave nodes in contact
    real(DP) :: residual = 0                   !< largest force imbalance over the largest force [-]
    real(DP) :: correction = 0                 !< largest correction over the largest increment of displacement [-]
    integer :: n_status(0:2) = 0               !< slave nodes open, stick, slip
    integer :: n_scenario(4) = 0               !< slave nodes in scenario I to IV
    integer :: n_slip_converged = 0                  !< slipping slave nodes in equilibrium: friction limit reached, no residual
    integer :: n_newly_opened = 0, n_newly_closed = 0  !< slave nodes that opened and that closed in this iteration
    real(DP) :: step_length = 1                !< of the line search (mean of the nodes for NODAL) [-]
    integer :: n_krylov = 0                    !< Krylov iterations
    integer :: n_subproblem_iterations = 0                    !< iterations of the contact subproblem with the bulk linearized
    real(DP) :: max_gap_error = 0                  !< largest penetration or opening of a closed node [length]
  end type iteration_record_type

  !> One attempt at an increment (a row of .sta and of the history tables).
  type :: increment_record_type
    integer :: step = 0, increment = 0, attempt = 0
    logical :: is_converged = .false.
    real(DP) :: total_time = 0                 !< at its end [time]
    real(DP) :: step_time = 0                  !< at its end [time]
    real(DP) :: dt = 0                         !< [time]
    integer :: n_iterations = 0
    integer :: n_cutbacks = 0                  !< failed attempts at this increment before
    integer :: n_status(0:2) = 0               !< at the end: open, stick, slip
    integer :: n_scenario(4) = 0               !< summed over the iterations
    integer :: n_factorisations = 0
    integer :: n_krylov = 0
    real(DP) :: smallest_step_length = 1       !< [-]
    real(DP) :: residual = 0                   !< last [-]
    real(DP) :: correction = 0                 !< last [-]
    real(DP) :: seconds(N_PHASES) = 0          !< by phase, since the record before [s]
    real(DP) :: megabytes(N_PHASES) = 0        !< growth of the peak memory by phase; only in the final summary [MB]
    real(DP) :: applied_force(3) = 0           !< sum over the model [force]
    real(DP) :: reaction_force(3) = 0          !< sum over the supports [force]
    real(DP) :: contact_force(3) = 0           !< sum on slave and master nodes; 0 in equilibrium [force]
    real(DP) :: slave_force(3) = 0             !< sum on the slave nodes alone [force]
    real(DP) :: external_work = 0              !< of loads and prescribed displacements since the start [energy]
    real(DP) :: friction_work = 0              !< dissipated since the start [energy]
    real(DP) :: plastic_work = 0               !< of plastic and creep strains since the start [energy]
    integer :: n_cycles_treated = 0                    !< cycles of slave nodes that were treated
    integer :: n_status_changes = 0                !< slave nodes whose status at the end was not that after the first iteration
    integer :: n_proximal = 0                   !< iterations with proximal regularization of unsupported bodies
    integer :: n_snap_through = 0                   !< of them, those with snap-through at a limit point
    real(DP) :: proximal_work_increment = 0                !< work of the regularization in this increment [energy]
    real(DP) :: proximal_work = 0               !< work of the regularization of unsupported bodies since the start [energy]
    real(DP) :: stabilization_work = 0                !< dissipated by the viscous forces of STABILIZE since the start [energy]
    real(DP) :: kinetic_energy = 0             !< of a DYNAMIC step [energy]
    real(DP) :: integration_loss = 0           !< dissipated by backward Euler in DYNAMIC steps since the start [energy]
    logical :: is_riks = .false.               !< of a RIKS step: times are lengths of the arc
    logical :: is_step_end = .false.           !< the last increment of its step
    real(DP) :: load_factor = 0                !< RIKS: load proportionality factor at its end; of a failed attempt at its start [-]
    real(DP) :: strain_energy = 0              !< stored in the elements [energy]
    real(DP) :: contact_energy = 0             !< stored in compliant contact [energy]
    type(failure_type) :: failure              !< why the attempt failed; FAILURE_NONE if it converged
    character(:), allocatable :: reason        !< the same as text, for output only; empty if it converged
    character(REPORT_LINE_LENGTH), allocatable :: report_lines(:)   !< of a failed attempt: worst nodes and a remedy; who left its
                                                                    !! master
  end type increment_record_type

end module amontons_iteration_records
