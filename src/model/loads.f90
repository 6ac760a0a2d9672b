!> Amplitudes, boundary conditions, concentrated and distributed loads, linear equations.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The reader resolves load propagation, OP=NEW and sets; each step then holds the complete list of its active loads.
module amontons_loads
  use amontons_kinds, only: DP
  implicit none
  private
  public :: equation_list_type, amplitude_type, load_type, prescribed_type, concentrated_type, distributed_type, temperature_type, &
    equation_type, foundation_type
  public :: AMPLITUDE_TABLE, AMPLITUDE_SMOOTH_STEP, AMPLITUDE_PERIODIC, AMPLITUDE_MODULATED, AMPLITUDE_DECAY
  public :: DISTRIBUTED_PRESSURE, DISTRIBUTED_GRAVITY, DISTRIBUTED_CENTRIFUGAL, DISTRIBUTED_BODY_FORCE, DISTRIBUTED_TRACTION, &
    amplitude_value, load_value, integrated_velocity, has_integral

  integer, parameter :: DISTRIBUTED_PRESSURE = 1   !< pressure on an element face, positive towards the element
  integer, parameter :: DISTRIBUTED_GRAVITY = 2    !< acceleration on an element, times its density
  integer, parameter :: DISTRIBUTED_CENTRIFUGAL = 3       !< square of the angular velocity of an element about an axis
  integer, parameter :: DISTRIBUTED_BODY_FORCE = 4       !< force per reference volume of an element
  integer, parameter :: DISTRIBUTED_TRACTION = 5   !< force per reference area of an element face, in a fixed direction

  integer, parameter :: AMPLITUDE_TABLE = 0           !< linear between the times, constant outside
  integer, parameter :: AMPLITUDE_SMOOTH_STEP = 1          !< the same with a polynomial whose slope and curvature are 0 at the
                                                           !! times
  integer, parameter :: AMPLITUDE_PERIODIC = 2        !< Fourier series from a time on
  integer, parameter :: AMPLITUDE_MODULATED = 3       !< product of two sines from a time on
  integer, parameter :: AMPLITUDE_DECAY = 4           !< exponential decay from a time on

  !> Factors over time.
  type :: amplitude_type
    character(:), allocatable :: name
    logical :: is_total_time = .false.           !< TIME=TOTAL TIME
    logical :: is_absolute = .false.             !< VALUE=ABSOLUTE: the factors are magnitudes and replace those of the load
    integer :: shape = AMPLITUDE_TABLE
    real(DP), allocatable :: formula_constants(:)          !< PERIODIC: omega, t0, A0, A1, B1, ...; MODULATED: A0, A, t0, omega 1,
                                                           !! omega 2;
    !< DECAY: A0, A, t0, td
    real(DP), allocatable :: time(:)             !< ascending [time]
    real(DP), allocatable :: factor(:)           !< [-]
    logical :: is_user = .false.                 !< DEFINITION=USER: UAMP gives the factor for each increment
    real(DP), allocatable :: props(:)            !< its properties
    integer :: n_svars = 0                       !< number of its variables
  end type amplitude_type

  !> A magnitude over a step: with an amplitude end * a(t), without one from start (t = 0) to end (t = period), linearly.
  type :: load_type
    real(DP) :: start = 0                        !< magnitude at the start of the step
    real(DP) :: end = 0                          !< magnitude at its end, or the reference magnitude of the amplitude
    integer :: amplitude = 0                     !< index into model%amplitudes; 0: none
    logical :: is_user = .false.                 !< DLOAD, UTRACLOAD or DISP gives the magnitude
  end type load_type

  !> A prescribed displacement of one degree of freedom. A dof appears once in a step.
  type, extends(load_type) :: prescribed_type
    integer :: node = 0                          !< node index
    integer :: dof = 0                           !< 1 to 3
    logical :: is_held = .false.                 !< FIXED: keeps the displacement that it has at the start of the step
    logical :: is_velocity = .false.             !< TYPE=VELOCITY: its integral from the displacement at the start of the step
    logical :: is_from_current = .false.         !< starts from the displacement at the start of the step instead of `start`
    integer :: global_step = 0                   !< SUBMODEL: step of the global model that gives its values, negative: data set;
                                                 !! 0: none
    logical :: is_time_scaled = .false.          !< TIMESCALE: the global step takes as long as this one
    logical :: is_balancing = .false.            !< of no card: holds a free motion and carries no force (`balanced_bodies`)
    integer :: line = 0                          !< line of the card in the deck, for messages
  end type prescribed_type

  !> A force on one degree of freedom; several add up.
  type, extends(load_type) :: concentrated_type
    integer :: node = 0
    integer :: dof = 0
    logical :: is_follower = .false.             !< under NLGEOM it turns with the rotation node of its node
  end type concentrated_type

  !> A load on one element or one of its faces; several add up.
  type, extends(load_type) :: distributed_type
    integer :: kind = DISTRIBUTED_PRESSURE
    integer :: element = 0
    integer :: face = 0                          !< face number, of pressure and traction only
    real(DP) :: direction(3) = 0                 !< unit vector: of gravity, body forces and traction, or the axis of rotation
    logical :: is_follower = .false.            !< a traction defined to rotate with its face, which matters under NLGEOM
    logical :: is_shear = .false.                !< a traction by UTRACLOAD: its part along the face
    integer :: surface = 0                       !< of a traction by UTRACLOAD; 0: it was given on elements
    real(DP) :: point(3) = 0                     !< a point of the axis of rotation [length]
    integer :: node = 0                          !< whose prescribed displacement 2 the pressure is; 0: none
  end type distributed_type

  !> FOUNDATION: springs to the ground on a face of an element, in all steps.
  type :: foundation_type
    integer :: element = 0
    integer :: face = 0                          !< number of the face
    real(DP) :: stiffness = 0                    !< along the normal, per area [force/length^3]
  end type foundation_type

  !> The temperature of a node.
  type, extends(load_type) :: temperature_type
    integer :: node = 0
    integer :: global_step = 0                   !< as of prescribed_type
    integer :: line = 0                          !< of the card in the deck, for messages
    logical :: is_time_scaled = .false.          !< as of prescribed_type
    logical :: is_from_current = .true.          !< without an amplitude it starts from the temperature before the step
  end type temperature_type

  !> sum coefficient * u(node, dof) = 0. One of the first terms is eliminated.
  type :: equation_type
    integer, allocatable :: node(:)
    integer, allocatable :: dof(:)
    real(DP), allocatable :: coefficient(:)
    integer :: n_eliminable = 1                  !< number of first terms that may be eliminated
    character(24) :: card = 'EQUATION'           !< keyword of the card that defines it, for messages
    integer :: line = 0                          !< line of the card in the deck, for messages
    integer :: deck_dof = 0                     !< degree of freedom of the first term as given in the deck
    integer :: first_step = 1                    !< the first step in which it is active
    integer :: last_step = huge(1)               !< EQUATION, REMOVE: the last step in which it is active
    logical :: is_balancing = .false.            !< of no card: a support that carries no force (`balanced_bodies`)
  end type equation_type

  !> Equations that are added one by one. The array doubles when it is full, and its equations are moved, not copied.
  type :: equation_list_type
    type(equation_type), allocatable :: items(:)
    integer :: n = 0                             !< equations; the rest of the items is empty
  contains
    procedure :: add => add_equation_to_list
    procedure :: move_to => move_equations_to
  end type equation_list_type

contains

  !> The factor of an amplitude at a time.
  pure function amplitude_value(amplitude, time) result(factor)
    type(amplitude_type), intent(in) :: amplitude
    real(DP), intent(in) :: time                 !< step time, or total time if it is_total_time [time]
    real(DP) :: factor, s
    integer :: i, n
    if (amplitude%shape >= AMPLITUDE_PERIODIC) then
      factor = formula_value(amplitude, time)
      return
    end if
    n = size(amplitude%time)
    if (time <= amplitude%time(1)) then
      factor = amplitude%factor(1)
    else if (time >= amplitude%time(n)) then
      factor = amplitude%factor(n)
    else
      i = 1
      do while (amplitude%time(i + 1) < time)
        i = i + 1
      end do
      s = (time - amplitude%time(i)) / (amplitude%time(i + 1) - amplitude%time(i))
      if (amplitude%shape == AMPLITUDE_SMOOTH_STEP) s = s**3 * (10 + s * (6 * s - 15))
      factor = amplitude%factor(i) + s * (amplitude%factor(i + 1) - amplitude%factor(i))
    end if
  end function amplitude_value


  !> The displacement since the start of the step by a velocity; without an amplitude the velocity is constant.
  pure function integrated_velocity(load, amplitudes, step_time, total_time) result(displacement)
    class(load_type), intent(in) :: load
    type(amplitude_type), intent(in) :: amplitudes(:)   !< model%amplitudes
    real(DP), intent(in) :: step_time, total_time       !< [time]
    real(DP) :: displacement, last
    displacement = load%end * step_time
    if (load%amplitude == 0) return
    associate (amplitude => amplitudes(load%amplitude))
      last = merge(total_time, step_time, amplitude%is_total_time)
      displacement = table_integral(amplitude, last) - table_integral(amplitude, last - step_time)
      if (.not. amplitude%is_absolute) displacement = load%end * displacement
    end associate
  end function integrated_velocity


  !> Whether an amplitude has an integral here: a table has, a formula or one of the user has none.
  elemental logical function has_integral(amplitude)
    type(amplitude_type), intent(in) :: amplitude
    has_integral = amplitude%shape < AMPLITUDE_PERIODIC .and. .not. amplitude%is_user
  end function has_integral


  !> The integral of a table from its first time to a time [time].
  pure real(DP) function table_integral(amplitude, time) result(sum_of_parts)
    type(amplitude_type), intent(in) :: amplitude
    real(DP), intent(in) :: time                 !< [time]
    real(DP) :: s, length
    integer :: i, n
    n = size(amplitude%time)
    sum_of_parts = min(0.0_DP, time - amplitude%time(1)) * amplitude%factor(1) + &
      max(0.0_DP, time - amplitude%time(n)) * amplitude%factor(n)
    do i = 1, n - 1
      length = amplitude%time(i + 1) - amplitude%time(i)
      s = min(1.0_DP, (time - amplitude%time(i)) / length)
      if (s <= 0) exit
      sum_of_parts = sum_of_parts + length * s * amplitude%factor(i)
      if (amplitude%shape == AMPLITUDE_SMOOTH_STEP) then
        s = s**4 * (2.5_DP + s * (s - 3))
      else
        s = 0.5_DP * s**2
      end if
      sum_of_parts = sum_of_parts + length * s * (amplitude%factor(i + 1) - amplitude%factor(i))
    end do
  end function table_integral


  !> The factor of an amplitude given by a formula.
  pure real(DP) function formula_value(amplitude, time) result(factor)
    type(amplitude_type), intent(in) :: amplitude
    real(DP), intent(in) :: time                 !< [time]
    real(DP) :: since, angle
    integer :: k
    associate (a => amplitude%formula_constants)
      select case (amplitude%shape)
      case (AMPLITUDE_PERIODIC)
        since = time - a(2)
        factor = a(3)
        if (since < 0) return
        do k = 1, (size(a) - 3) / 2
          angle = real(k, DP) * a(1) * since
          factor = factor + a(2 * k + 2) * cos(angle) + a(2 * k + 3) * sin(angle)
        end do
      case (AMPLITUDE_MODULATED)
        since = max(0.0_DP, time - a(3))
        factor = a(1) + a(2) * sin(a(4) * since) * sin(a(5) * since)
      case default
        factor = a(1)
        if (time >= a(3)) factor = a(1) + a(2) * exp(-(time - a(3)) / a(4))
      end select
    end associate
  end function formula_value


  !> The magnitude of a load within its step.
  pure function load_value(load, amplitudes, step_time, total_time, period) result(magnitude)
    class(load_type), intent(in) :: load
    type(amplitude_type), intent(in) :: amplitudes(:)   !< model%amplitudes
    real(DP), intent(in) :: step_time                   !< [time]
    real(DP), intent(in) :: total_time                  !< [time]
    real(DP), intent(in) :: period                      !< length of the step [time]
    real(DP) :: magnitude
    if (load%amplitude == 0) then
      magnitude = load%start + (load%end - load%start) * (step_time / period)
      return
    end if
    associate (amplitude => amplitudes(load%amplitude))
      magnitude = amplitude_value(amplitude, merge(total_time, step_time, amplitude%is_total_time))
      if (.not. amplitude%is_absolute) magnitude = load%end * magnitude
    end associate
  end function load_value


  !> Adds an equation. Cost: constant in the mean.
  pure subroutine add_equation_to_list(self, equation)
    class(equation_list_type), intent(inout) :: self
    type(equation_type), intent(in) :: equation
    if (.not. allocated(self%items)) allocate (self%items(16))
    if (self%n == size(self%items)) call resize_equations(self%items, 2 * self%n)
    self%n = self%n + 1
    self%items(self%n) = equation
  end subroutine add_equation_to_list


  !> Moves the equations into an array of their number, after those that are there. After: the list is empty.
  pure subroutine move_equations_to(self, equations)
    class(equation_list_type), intent(inout) :: self
    type(equation_type), allocatable, intent(inout) :: equations(:)
    integer :: i, n_before
    if (.not. allocated(equations)) allocate (equations(0))
    n_before = size(equations)
    call resize_equations(equations, n_before + self%n)
    do i = 1, self%n
      call move_equation(self%items(i), equations(n_before + i))
    end do
    self%n = 0
  end subroutine move_equations_to


  !> Changes the size of an array of equations; those that both sizes have are moved.
  pure subroutine resize_equations(equations, n)
    type(equation_type), allocatable, intent(inout) :: equations(:)
    integer, intent(in) :: n
    type(equation_type), allocatable :: resized(:)
    integer :: i
    allocate (resized(n))
    do i = 1, min(n, size(equations))
      call move_equation(equations(i), resized(i))
    end do
    call move_alloc(resized, equations)
  end subroutine resize_equations


  !> Moves an equation; the terms of the first one are deallocated after.
  pure subroutine move_equation(from, to)
    type(equation_type), intent(inout) :: from
    type(equation_type), intent(out) :: to
    call move_alloc(from%node, to%node)
    call move_alloc(from%dof, to%dof)
    call move_alloc(from%coefficient, to%coefficient)
    to%n_eliminable = from%n_eliminable
    to%card = from%card
    to%line = from%line
    to%deck_dof = from%deck_dof
    to%first_step = from%first_step
    to%last_step = from%last_step
    to%is_balancing = from%is_balancing
  end subroutine move_equation

end module amontons_loads
