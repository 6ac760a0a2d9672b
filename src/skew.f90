!> Skew: what the tangent has beside the symmetric matrix K: of pressures that follow their faces, and of unsymmetric laws.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The load stiffness k = dF_ext/du of a face is not symmetric. Its symmetric part goes into K; W = (k - k')/2, summed over
!! the faces, stays here, a sparse matrix that only the operator of GMRES sees. Inside a pressurised surface the faces
!! cancel each other, so W lives on its rim; where the rim is held nothing is left of it. A material whose tangent is not
!! symmetric gives its elements such a part too, with the other sign, since it belongs to F_int; it has the pattern of K.
!! Reference: J. Bonet, R. D. Wood, Nonlinear Continuum Mechanics for Finite Element Analysis (2008), section 8.5.
module amontons_skew
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, from_triplets, multiply, sum_of, transpose_of
  implicit none
  private
  public :: skew_type, begin_elements, begin_skew, add_skew_face, finish_skew, subtract_skew, with_skew

  real(DP), parameter :: CANCELLED = 1.0e-12_DP    !< of the largest entry of a face: rounding of what cancels [-]

  !> W, and its entries while the faces are visited.
  type :: skew_type
    integer :: n = 0                               !< entries collected
    integer, allocatable :: row(:), column(:)      !< (>= n)
    real(DP), allocatable :: value(:)              !< (>= n) [force/length]
    type(sparse_type) :: elements                  !< U: elements add U - U' [force/length]; not made if not wanted
    type(sparse_type) :: matrix                    !< W over all unknowns, elements included [force/length]; not made if it is zero
  end type skew_type

contains

  !> Nothing is collected from faces yet, and W is zero.
  pure subroutine begin_skew(skew)
    type(skew_type), intent(inout) :: skew
    skew%n = 0
    skew%matrix = sparse_type()
    if (allocated(skew%row)) return
    allocate (skew%row(1024), skew%column(1024), skew%value(1024))
  end subroutine begin_skew


  !> Adds (k - k')/2 of a face.
  pure subroutine add_skew_face(skew, nodes, stiffness)
    type(skew_type), intent(inout) :: skew
    integer, intent(in) :: nodes(:)                !< of the face
    real(DP), intent(in) :: stiffness(:, :)        !< k, three rows and columns a node [force/length]
    integer :: i, j, m
    m = 3 * size(nodes)
    do while (skew%n + m * m > size(skew%value))
      skew%row = [skew%row, skew%row]
      skew%column = [skew%column, skew%column]
      skew%value = [skew%value, skew%value]
    end do
    do j = 1, m
      do i = 1, m
        skew%n = skew%n + 1
        skew%row(skew%n) = 3 * nodes((i + 2) / 3) - 2 + mod(i - 1, 3)
        skew%column(skew%n) = 3 * nodes((j + 2) / 3) - 2 + mod(j - 1, 3)
        skew%value(skew%n) = 0.5_DP * (stiffness(i, j) - stiffness(j, i))
      end do
    end do
  end subroutine add_skew_face


  !> The elements are about to be assembled: the upper triangle of what they bring, with the pattern of K, is zero.
  pure subroutine begin_elements(skew, K, is_wanted)
    type(skew_type), intent(inout) :: skew
    type(sparse_type), intent(in) :: K             !< upper triangle
    logical, intent(in) :: is_wanted               !< a material may be unsymmetric
    if (.not. is_wanted) return
    if (.not. allocated(skew%elements%value)) skew%elements = K
    skew%elements%value = 0
  end subroutine begin_elements


  !> Sums up what was collected. Errors: out of memory.
  subroutine finish_skew(skew, n_unknowns, error)
    type(skew_type), intent(inout) :: skew
    integer, intent(in) :: n_unknowns
    type(error_type), allocatable, intent(out) :: error
    call sum_faces(skew, n_unknowns, error)
    if (allocated(error) .or. .not. allocated(skew%elements%value)) return
    if (all(skew%elements%value == 0.0_DP)) return
    if (allocated(skew%matrix%first)) then
      skew%matrix = sum_of(skew%matrix, 1.0_DP, transpose_of(skew%elements))
    else
      skew%matrix = transpose_of(skew%elements)
    end if
    skew%matrix = sum_of(skew%matrix, -1.0_DP, skew%elements)
  end subroutine finish_skew


  !> W of the faces; what they cancel is left out. Errors: out of memory.
  subroutine sum_faces(skew, n_unknowns, error)
    type(skew_type), intent(inout) :: skew
    integer, intent(in) :: n_unknowns
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: whole
    integer, allocatable :: row(:)
    logical, allocatable :: is_left(:)
    integer :: i
    if (skew%n == 0) return
    associate (n => skew%n)
      call from_triplets(n_unknowns, n_unknowns, skew%row(:n), skew%column(:n), skew%value(:n), whole, error)
      if (allocated(error)) return
      is_left = abs(whole%value) > CANCELLED * maxval(abs(skew%value(:n)))
    end associate
    if (.not. any(is_left)) return
    allocate (row(size(whole%value)))
    do i = 1, n_unknowns
      row(whole%first(i):whole%first(i + 1) - 1) = i
    end do
    call from_triplets(n_unknowns, n_unknowns, pack(row, is_left), pack(whole%column, is_left), pack(whole%value, is_left), &
      skew%matrix, error)
  end subroutine sum_faces


  !> w = w - W du.
  subroutine subtract_skew(skew, du, w)
    type(skew_type), intent(in) :: skew
    real(DP), intent(in) :: du(:)                  !< (n_unknowns) [length]
    real(DP), intent(inout) :: w(:)                !< (n_unknowns) [force]
    real(DP), allocatable :: change(:)
    if (.not. allocated(skew%matrix%first)) return
    allocate (change, mold=w)
    call multiply(skew%matrix, du, change)
    w = w - change
  end subroutine subtract_skew


  !> K - W.
  function with_skew(K, skew) result(whole)
    type(sparse_type), intent(in) :: K             !< all entries, not a triangle
    type(skew_type), intent(in) :: skew
    type(sparse_type) :: whole
    if (allocated(skew%matrix%first)) then
      whole = sum_of(K, -1.0_DP, skew%matrix)
    else
      whole = K
    end if
  end function with_skew

end module amontons_skew
