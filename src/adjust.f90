!> Adjust: slave nodes of pairs with ADJUST are moved onto their master before the first step, without stress.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_adjust
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_model, only: model_type
  use amontons_state, only: state_type, slave_type, create_state
  use amontons_contact, only: contact_type, create_contact
  use amontons_contact_start, only: begin_contact_increment
  implicit none
  private
  public :: adjust_slaves

contains

  !> Moves the slave nodes that penetrate or are nearer than the distance, along the master's normal; those of the given
  !! set wherever they are. A mid-side node that follows its corners moves by half of what they move.
  !!
  !! As in Abaqus and CalculiX the mesh itself is changed. Cost: one search.
  subroutine adjust_slaves(model, n_moved, largest, error)
    type(model_type), intent(inout) :: model       !< its coordinates are changed
    integer, intent(out) :: n_moved                !< nodes moved
    real(DP), intent(out) :: largest               !< longest way [length]
    type(error_type), allocatable, intent(out) :: error
    type(contact_type) :: contact
    type(model_type) :: by_nodes                   ! the same with node-to-surface contact: nodes are moved, not faces
    type(state_type) :: state
    type(slave_type), allocatable :: slaves(:)
    real(DP) :: way(3, model%mesh%n_nodes)
    integer :: s, i
    n_moved = 0
    largest = 0.0_DP
    if (.not. any(model%pairs%has_adjust)) return
    by_nodes = model
    by_nodes%pairs%is_mortar = .false.
    by_nodes%pairs%is_pointwise = .false.
    call create_contact(contact, by_nodes, slaves, error)
    if (allocated(error)) return
    call create_state(state, model%mesh, slaves)
    call begin_contact_increment(contact, by_nodes, .true., .true., state%new%u, state%new)
    way = 0.0_DP
    do s = 1, size(state%new%slaves)
      associate (slave => state%new%slaves(s))
        if (is_wanted(model, slave)) way(:, slave%node) = -(slave%gap - slave%offset) * slave%normal
      end associate
    end do
    do i = 1, size(contact%follower, 2)
      associate (f => contact%follower(:, i))
        way(:, f(1)) = 0.5_DP * (way(:, f(2)) + way(:, f(3)))
      end associate
    end do
    n_moved = count(norm2(way, dim=1) > 0.0_DP)
    largest = maxval(norm2(way, dim=1))
    model%mesh%coordinates = model%mesh%coordinates + way
  end subroutine adjust_slaves


  !> Whether a slave node is to be moved.
  pure logical function is_wanted(model, slave)
    type(model_type), intent(in) :: model
    type(slave_type), intent(in) :: slave
    is_wanted = .false.
    associate (pair => model%pairs(slave%pair))
      if (.not. pair%has_adjust .or. slave%facet == 0) return
      if (allocated(pair%adjust_nodes)) then
        is_wanted = any(pair%adjust_nodes == slave%node)
      else
        is_wanted = slave%gap - slave%offset <= pair%adjust
      end if
    end associate
  end function is_wanted

end module amontons_adjust
