!> Follower: what a pressure that follows its face adds to the tangent beside the symmetric part that K holds.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The load stiffness k = dF_ext/du of a face is not symmetric. Its symmetric part goes into K; W = (k - k')/2, summed over
!! the faces, stays here, a sparse matrix that only the operator of GMRES sees. Inside a pressurised surface the faces
!! cancel each other, so W lives on its rim; where the rim is held nothing is left of it.
!! Reference: J. Bonet, R. D. Wood, Nonlinear Continuum Mechanics for Finite Element Analysis (2008), section 8.5.
module amontons_follower
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, from_triplets, multiply, sum_of
  implicit none
  private
  public :: follower_type, begin_follower, add_follower, finish_follower, subtract_follower, with_follower

  real(DP), parameter :: CANCELLED = 1.0e-12_DP    !< of the largest entry of a face: rounding of what cancels [-]

  !> W, and its entries while the faces are visited.
  type :: follower_type
    integer :: n = 0                               !< entries collected
    integer, allocatable :: row(:), column(:)      !< (>= n)
    real(DP), allocatable :: value(:)              !< (>= n) [force/length]
    type(sparse_type) :: matrix                    !< W over all unknowns [force/length]; not made if it is zero
  end type follower_type

contains

  !> Nothing is collected yet, and W is zero.
  pure subroutine begin_follower(follower)
    type(follower_type), intent(inout) :: follower
    follower%n = 0
    follower%matrix = sparse_type()
    if (allocated(follower%row)) return
    allocate (follower%row(1024), follower%column(1024), follower%value(1024))
  end subroutine begin_follower


  !> Adds (k - k')/2 of a face.
  pure subroutine add_follower(follower, nodes, stiffness)
    type(follower_type), intent(inout) :: follower
    integer, intent(in) :: nodes(:)                !< of the face
    real(DP), intent(in) :: stiffness(:, :)        !< k, three rows and columns a node [force/length]
    integer :: i, j, m
    m = 3 * size(nodes)
    do while (follower%n + m * m > size(follower%value))
      follower%row = [follower%row, follower%row]
      follower%column = [follower%column, follower%column]
      follower%value = [follower%value, follower%value]
    end do
    do j = 1, m
      do i = 1, m
        follower%n = follower%n + 1
        follower%row(follower%n) = 3 * nodes((i + 2) / 3) - 2 + mod(i - 1, 3)
        follower%column(follower%n) = 3 * nodes((j + 2) / 3) - 2 + mod(j - 1, 3)
        follower%value(follower%n) = 0.5_DP * (stiffness(i, j) - stiffness(j, i))
      end do
    end do
  end subroutine add_follower


  !> Sums up what was collected; what the faces cancel is left out. Errors: out of memory.
  subroutine finish_follower(follower, n_unknowns, error)
    type(follower_type), intent(inout) :: follower
    integer, intent(in) :: n_unknowns
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: whole
    integer, allocatable :: row(:)
    logical, allocatable :: is_left(:)
    integer :: i
    if (follower%n == 0) return
    associate (n => follower%n)
      call from_triplets(n_unknowns, n_unknowns, follower%row(:n), follower%column(:n), follower%value(:n), whole, error)
      if (allocated(error)) return
      is_left = abs(whole%value) > CANCELLED * maxval(abs(follower%value(:n)))
    end associate
    if (.not. any(is_left)) return
    allocate (row(size(whole%value)))
    do i = 1, n_unknowns
      row(whole%first(i):whole%first(i + 1) - 1) = i
    end do
    call from_triplets(n_unknowns, n_unknowns, pack(row, is_left), pack(whole%column, is_left), pack(whole%value, is_left), &
      follower%matrix, error)
  end subroutine finish_follower


  !> w = w - W du.
  subroutine subtract_follower(follower, du, w)
    type(follower_type), intent(in) :: follower
    real(DP), intent(in) :: du(:)                  !< (n_unknowns) [length]
    real(DP), intent(inout) :: w(:)                !< (n_unknowns) [force]
    real(DP), allocatable :: change(:)
    if (.not. allocated(follower%matrix%first)) return
    allocate (change, mold=w)
    call multiply(follower%matrix, du, change)
    w = w - change
  end subroutine subtract_follower


  !> K - W.
  function with_follower(K, follower) result(whole)
    type(sparse_type), intent(in) :: K             !< all entries, not a triangle
    type(follower_type), intent(in) :: follower
    type(sparse_type) :: whole
    if (allocated(follower%matrix%first)) then
      whole = sum_of(K, -1.0_DP, follower%matrix)
    else
      whole = K
    end if
  end function with_follower

end module amontons_follower
