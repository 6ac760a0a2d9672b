!> Springs: the law of a spring or gap that is more than one constant: tables, temperatures, directions of its own.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/elements.md, section "Trusses, springs, gaps and masses".
module amontons_springs
  use amontons_kinds, only: DP, PI
  use amontons_materials, only: curve_type, table_type, evaluate_curve, evaluate_table, find_interval
  implicit none
  private
  public :: spring_type, spring_force

  !> The law of the springs of one card.
  type :: spring_type
    type(table_type) :: constant                 !< over the temperature; not there: force, or the gap [force/length]
    type(curve_type), allocatable :: force(:)    !< (temperatures) force (stress) over the elongation (strain)
    logical :: is_gap = .false.
    logical :: is_rope = .false.
    integer :: length_node = 0                   !< of a rope: the node that tells its length; it moves nothing
    real(DP) :: clearance = 0                    !< of a gap at the start, or of a rope: by how much it is slack [length]
    real(DP) :: stiffness = 0                    !< of a closed gap, of a taut rope [force/length]
    real(DP) :: pull = 0                         !< of a gap that is wide open [force]
    real(DP) :: axes(3, 2) = 0                   !< directions at its nodes, in place of 1 to 3; zero: not given
  end type spring_type

contains

  !> Tension of a spring and its derivative.
  !!
  !! Gap: with the overclosure d = - clearance - elongation the tension is - k d (1/2 + atan(d/eps)/pi), eps = pi pull/k, so that
  !! far away pull is left of it, and k d when closed. Reference: CalculiX's manual, sections "GAPUNI" and "*GAP".
  pure subroutine spring_force(spring, elongation, temperature, tension, slope)
    type(spring_type), intent(in) :: spring
    real(DP), intent(in) :: elongation           !< [length]
    real(DP), intent(in) :: temperature          !< [temperature]
    real(DP), intent(out) :: tension             !< [force]
    real(DP), intent(out) :: slope               !< d tension / d elongation [force/length]
    real(DP) :: constant(1), d, eps
    if (spring%is_gap) then
      d = -spring%clearance - elongation
      eps = PI * spring%pull / spring%stiffness
      tension = -spring%stiffness * d * (0.5_DP + atan2(d, eps) / PI)
      slope = spring%stiffness * (0.5_DP + (atan2(d, eps) + d * eps / (d**2 + eps**2 + tiny(1.0_DP))) / PI)
    else if (spring%is_rope) then
      d = elongation - spring%clearance
      slope = merge(spring%stiffness, 0.0_DP, d > 0.0_DP)
      tension = slope * d
    else if (allocated(spring%force)) then
      call force_by_tables(spring%force, elongation, temperature, tension, slope)
    else
      call evaluate_table(spring%constant, temperature, constant)
      tension = constant(1) * elongation
      slope = constant(1)
    end if
  end subroutine spring_force


  !> Force and slope by tables, linear in between and constant outside, also over the temperature.
  pure subroutine force_by_tables(tables, elongation, temperature, force, slope)
    type(curve_type), intent(in) :: tables(:)    !< ascending temperatures
    real(DP), intent(in) :: elongation, temperature
    real(DP), intent(out) :: force, slope
    real(DP) :: s, other_force, other_slope
    integer :: i
    call find_interval(tables%temperature, temperature, i, s)
    call force_of(tables(i), force, slope)
    if (.not. s > 0) return
    call force_of(tables(i + 1), other_force, other_slope)
    force = force + s * (other_force - force)
    slope = slope + s * (other_slope - slope)

  contains

    !> One table.
    pure subroutine force_of(table, f, df)
      type(curve_type), intent(in) :: table
      real(DP), intent(out) :: f, df
      call evaluate_curve(table, elongation, f, df)
      if (elongation < table%strain(1)) df = 0
    end subroutine force_of

  end subroutine force_by_tables

end module amontons_springs
