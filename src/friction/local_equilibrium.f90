!> Meeting: the force of a compliant law at a slave node, where what the law gives and what the bodies ask for come together.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/contact.md, "The law and the bodies meet". On the way to equilibrium a stiff law makes forces of a gap that is
!! only a little wrong that are wrong by far. So the law is not taken at the gap as it is, but where the node would find its balance
!! if it alone moved, against the stiffness c of its body. In equilibrium both are the same place.
module amontons_local_equilibrium
  use amontons_kinds, only: DP
  use amontons_tensor, only: outer, IDENTITY
  use amontons_surfaces, only: interaction_type, BEHAVIOR_TIED
  use amontons_slip_scenarios, only: is_friction_capped
  use amontons_pressure_overclosure, only: law_pressure, law_reach, shear_most
  implicit none
  private
  public :: meeting_type, asked_type, meet_law

  integer, parameter :: MOST_STEPS = 60            !< of the search for the overclosure, which halves its bracket at least
  real(DP), parameter :: EXACT = 1.0e-14_DP        !< what the search may leave, relative [-]

  !> What a slave node is asked for.
  type :: asked_type
    real(DP) :: area = 0                           !< [length^2]
    real(DP) :: stiffness = 0                      !< c of its body; 0: the law is taken where the node is [force/length]
    real(DP) :: overclosure = 0                    !< h, minus its gap [length]
    real(DP) :: normal(3) = 0                      !< out of the master
    real(DP) :: slip(3) = 0                        !< e: elastic slip if all were elastic, along the master [length]
    real(DP) :: imbalance(3) = 0                   !< Rhat of the node [force]
    real(DP) :: free(3, 3) = 0                     !< projector on the directions in which contact has to answer the imbalance
  end type asked_type

  !> The law where both meet.
  type :: meeting_type
    logical :: is_open = .true.
    logical :: is_slipping = .false.
    real(DP) :: pressure = 0                       !< [stress]
    real(DP) :: slope = 0                          !< of the pressure by the overclosure [stress/length]
    real(DP) :: energy = 0                         !< [energy]
    real(DP) :: shear(3) = 0                       !< S [force]
    real(DP) :: elastic(3) = 0                     !< elastic slip [length]
    real(DP) :: slip(3) = 0                        !< what of e is not [length]
    real(DP) :: by_slip(3, 3) = 0                  !< dS/de [force/length]
    real(DP) :: by_gap(3) = 0                      !< dS/dg [force/length]
    real(DP) :: ahead(3) = 0                       !< what the linearised law gives more where the node is than here [force]
  end type meeting_type

contains

  !> Pressure and shear where law and bodies meet, and how they change.
  pure subroutine meet_law(law, asked, met)
    type(interaction_type), intent(in) :: law
    type(asked_type), intent(in) :: asked
    type(meeting_type), intent(out) :: met
    real(DP) :: lawful(3), wanted(3), h, N, excess
    call take_law(law, asked, lawful, met%is_open)
    wanted = lawful
    if (asked%stiffness > 0.0_DP) wanted = lawful - matmul(asked%free, asked%imbalance + lawful)
    N = dot_product(asked%normal, wanted)
    if (asked%stiffness > 0.0_DP) call find_overclosure(law, asked, N, met%is_open, h)
    if (.not. asked%stiffness > 0.0_DP) h = asked%overclosure
    if (met%is_open) return
    call law_pressure(law, h, met%pressure, met%slope, met%energy)
    met%energy = asked%area * met%energy
    excess = asked%area * met%slope * (asked%overclosure - h)
    call meet_shear(law, asked, N * asked%normal - wanted, excess, met)
    met%ahead = met%ahead + excess * asked%normal
  end subroutine meet_law


  !> The force of the law where the node is.
  pure subroutine take_law(law, asked, force, is_open)
    type(interaction_type), intent(in) :: law
    type(asked_type), intent(in) :: asked
    real(DP), intent(out) :: force(3)              !< [force]
    logical, intent(out) :: is_open                !< beyond its reach
    real(DP) :: p, slope, energy, length, shear
    force = 0.0_DP
    is_open = -asked%overclosure > law_reach(law, asked%area)
    if (is_open) return
    call law_pressure(law, asked%overclosure, p, slope, energy)
    length = norm2(asked%slip)
    shear = min(law%stick_slope * asked%area * length, shear_most(law, asked%area, p))
    force = asked%area * p * asked%normal
    if (length > 0.0_DP) force = force - shear / length * asked%slip
  end subroutine take_law


  !> The overclosure h' at which A p(h') + c (h' - h) is the normal force that is wanted.
  !!
  !! Within the reach of the law the left side grows with h'. At the end of the reach it may jump; where there is no root on either
  !! side, or one on both, the node is open if it is beyond the reach.
  pure subroutine find_overclosure(law, asked, wanted, is_open, h)
    type(interaction_type), intent(in) :: law
    type(asked_type), intent(in) :: asked
    real(DP), intent(in) :: wanted                 !< N [force]
    logical, intent(inout) :: is_open              !< in: by the place of the node
    real(DP), intent(out) :: h                     !< [length]
    real(DP) :: low, high, without, p, slope, energy, left
    integer :: i
    logical :: is_reached
    without = asked%overclosure + wanted / asked%stiffness   ! where it would be without any pressure
    low = -law_reach(law, asked%area)
    is_reached = .true.
    if (low > -huge(1.0_DP)) then
      call law_pressure(law, low, p, slope, energy)
      is_reached = asked%area * p + asked%stiffness * (low - without) <= 0.0_DP
    end if
    if (is_reached .neqv. without < low) is_open = .not. is_reached
    h = max(low, asked%overclosure)
    if (is_open) return
    if (.not. is_reached) h = low
    if (.not. is_reached) return
    high = huge(1.0_DP)
    do i = 1, MOST_STEPS
      call law_pressure(law, h, p, slope, energy)
      left = asked%area * p + asked%stiffness * (h - without)
      if (left > 0.0_DP) high = min(high, h)
      if (left <= 0.0_DP) low = max(low, h)
      if (abs(left) <= EXACT * (asked%area * abs(p) + asked%stiffness * (abs(h) + abs(without)))) exit
      h = h - left / (asked%area * slope + asked%stiffness)
      if (h <= low .or. h >= high) h = 0.5_DP * (low + high)
    end do
  end subroutine find_overclosure


  !> Shear up to its limit by the pressure that was found; in the same way.
  pure subroutine meet_shear(law, asked, wanted, excess, met)
    type(interaction_type), intent(in) :: law
    type(asked_type), intent(in) :: asked
    real(DP), intent(in) :: wanted(3)              !< minus the shear force that the bodies ask for [force]
    real(DP), intent(in) :: excess                 !< what the normal force has more where the node is [force]
    type(meeting_type), intent(inout) :: met
    real(DP) :: trial(3), k, c, limit, length, q(3)
    k = law%stick_slope * asked%area
    c = merge(asked%stiffness, k, asked%stiffness > 0.0_DP)   ! without one the bodies ask for what the law gives, with any c
    limit = shear_most(law, asked%area, met%pressure)
    met%is_slipping = k <= 0.0_DP
    if (met%is_slipping) then
      met%slip = asked%slip
      return
    end if
    trial = wanted + c * asked%slip
    length = norm2(trial)
    met%is_slipping = k / (k + c) * length > limit
    if (.not. met%is_slipping) then
      met%elastic = trial / (k + c)
      met%shear = -k * met%elastic
      met%by_slip = -k * IDENTITY
      met%ahead = -k * (asked%slip - met%elastic)
      met%energy = met%energy + 0.5_DP * k * dot_product(met%elastic, met%elastic)
      return
    end if
    q = trial / length
    met%elastic = limit / k * q
    met%slip = asked%slip - met%elastic
    met%shear = -limit * q
    met%energy = met%energy + 0.5_DP * limit**2 / k
    met%by_slip = -limit * c / (length - limit) * (IDENTITY - outer(q, q))
    met%ahead = matmul(met%by_slip, asked%slip)
    if (law%behavior == BEHAVIOR_TIED .or. met%pressure <= 0.0_DP .or. &
      is_friction_capped(law%friction, met%pressure, law%shear_limit)) return
    met%by_gap = law%friction * met%slope * asked%area * q
    met%ahead = met%ahead - law%friction * excess * q
  end subroutine meet_shear

end module amontons_local_equilibrium
