!> Two-level preconditioner: incomplete Cholesky plus a coarse space of rigid body motions of mesh parts.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! It replaces a Cholesky factor that would be too large. Two levels, added:
!!
!!     inv(A)  ~  inv(U'U)  +  Z inv(Z'AZ) Z'
!!
!! U is an incomplete Cholesky factor with the pattern of A, in single precision: it reduces the oscillatory error. The columns of
!! Z are the six rigid body motions of each part of a METIS partition: they reduce the smooth error across the whole
!! body. Both are symmetric and positive definite, so that conjugate gradients can use the sum.
!! References: Meijerink and van der Vorst, Math. Comp. 31 (1977) 148; Manteuffel, Math. Comp. 34 (1980) 473 (the shift);
!! Nicolaides, SIAM J. Numer. Anal. 24 (1987) 355 and Mandel, Comm. Numer. Meth. Engng 9 (1993) 233 (motions of parts).
module amontons_two_level_preconditioner
  use amontons_kinds, only: DP, SP
  use amontons_sparse, only: sparse_type
  use amontons_dense, only: invert_spd, solve_symmetric_eigen, multiply_dense_symmetric, DENSE_OK
  implicit none
  private
  public :: two_level_preconditioner_type, build_coarse_space, factorise_two_level, apply_preconditioner, choose_n_parts, &
    two_level_megabytes
  public :: rigid_motion

  integer, parameter :: TARGET_NODES_PER_PART = 60              !< target size of a part; MAX_PARTS has precedence
  integer, parameter :: MAX_PARTS = 400               !< six columns each: limit of a cheap dense inverse
  integer, parameter :: MAX_SHIFTS = 10             !< shifts of the diagonal
  real(DP), parameter :: INITIAL_SHIFT = 4.0e-3_DP       !< of the diagonal, if the factorization breaks down [-]
  real(DP), parameter :: MIN_PIVOT_RATIO = 1.0e-3_DP          !< smallest accepted pivot over its diagonal entry [-]
  real(DP), parameter :: TOL_DEPENDENT_MOTION = 1.0e-8_DP         !< a motion with a smaller independent component is dropped [-]

  !> The preconditioner of one matrix.
  type :: two_level_preconditioner_type
    integer :: n = 0                                   !< unknowns
    real(SP), allocatable :: value(:)                  !< U, in the pattern of A; its diagonal as the reciprocal
    real(DP) :: shift = 0                              !< of the diagonal, used by the factor [-]
    integer :: n_parts = 0
    integer, allocatable :: part(:)                    !< (n) of each unknown
    real(DP), allocatable :: motion(:, :)              !< (6, n) rigid body motions of its part at each unknown, orthonormal
    real(DP), allocatable :: coarse(:, :)              !< (6 n_parts, 6 n_parts) inverse of Z'AZ
  end type two_level_preconditioner_type

contains

  !> Number of parts for a number of nodes.
  pure integer function choose_n_parts(n_nodes) result(n_parts)
    integer, intent(in) :: n_nodes
    n_parts = max(1, min(MAX_PARTS, n_nodes / TARGET_NODES_PER_PART))
  end function choose_n_parts


  !> Memory of the preconditioner [megabytes].
  pure real(DP) function two_level_megabytes(n, n_entries, n_parts) result(megabytes)
    integer, intent(in) :: n                           !< unknowns
    integer, intent(in) :: n_entries                   !< of the upper triangle
    integer, intent(in) :: n_parts
    megabytes = (12.0_DP * real(n_entries, DP) + 52.0_DP * real(n, DP) + 8.0_DP * (6.0_DP * real(n_parts, DP))**2) / 1.0e6_DP
  end function two_level_megabytes


  !> Z: the rigid body motions of each part at its unknowns, orthonormalized; dependent motions of a part become zero.
  subroutine build_coarse_space(self, part, axis, place, n_parts)
    type(two_level_preconditioner_type), intent(inout) :: self
    integer, intent(in) :: part(:)                     !< (n) of each unknown, 1 to n_parts
    integer, intent(in) :: axis(:)                     !< (n) direction of the unknown, 1 to 3
    real(DP), intent(in) :: place(:, :)                !< (3, n) coordinates of its node [length]
    integer, intent(in) :: n_parts
    real(DP) :: centre(3, n_parts), extent(n_parts), members(n_parts)
    integer :: i, p
    self%n_parts = n_parts
    self%part = part
    centre = 0
    members = 0
    do i = 1, size(part)
      centre(:, part(i)) = centre(:, part(i)) + place(:, i)
      members(part(i)) = members(part(i)) + 1
    end do
    do p = 1, n_parts
      centre(:, p) = centre(:, p) / max(members(p), 1.0_DP)
    end do
    extent = 0
    do i = 1, size(part)
      extent(part(i)) = max(extent(part(i)), maxval(abs(place(:, i) - centre(:, part(i)))))
    end do
    if (allocated(self%motion)) deallocate (self%motion)
    allocate (self%motion(6, size(part)))
    do i = 1, size(part)
      p = part(i)
      self%motion(:, i) = rigid_motion(axis(i), (place(:, i) - centre(:, p)) / max(extent(p), tiny(1.0_DP)))
    end do
    call orthonormalize_motions(self)
  end subroutine build_coarse_space


  !> Three translations and three rotations about the centre, at one unknown.
  pure function rigid_motion(axis, x) result(motion)
    integer, intent(in) :: axis                        !< 1 to 3
    real(DP), intent(in) :: x(3)                       !< from the centre, scaled to the part [-]
    real(DP) :: motion(6)
    motion = 0
    motion(axis) = 1
    select case (axis)
    case (1)
      motion(5:6) = [x(3), -x(2)]
    case (2)
      motion(4) = -x(3)
      motion(6) = x(1)
    case (3)
      motion(4:5) = [x(2), -x(1)]
    end select
  end function rigid_motion


  !> Orthonormalizes the six motions of each part: Z'Z is the identity, with zeros where a part has fewer than six.
  subroutine orthonormalize_motions(self)
    type(two_level_preconditioner_type), intent(inout) :: self
    real(DP) :: gram(6, 6, self%n_parts), turn(6, 6, self%n_parts), values(6), vectors(6, 6)
    integer :: i, p, m, status
    gram = 0
    do i = 1, size(self%part)
      do m = 1, 6
        gram(:, m, self%part(i)) = gram(:, m, self%part(i)) + self%motion(:, i) * self%motion(m, i)
      end do
    end do
    turn = 0
    do p = 1, self%n_parts
      call solve_symmetric_eigen(gram(:, :, p), values, vectors, status)
      if (status /= DENSE_OK) cycle
      do m = 1, 6
        if (values(m) > TOL_DEPENDENT_MOTION * values(6)) turn(m, :, p) = vectors(:, m) / sqrt(values(m))
      end do
    end do
    do i = 1, size(self%part)
      self%motion(:, i) = matmul(turn(:, :, self%part(i)), self%motion(:, i))
    end do
  end subroutine orthonormalize_motions


  !> Builds the preconditioner of a matrix: U and the inverse of Z'AZ.
  subroutine factorise_two_level(self, matrix, is_broken)
    type(two_level_preconditioner_type), intent(inout) :: self        !< after build_coarse_space, or without parts
    type(sparse_type), intent(in) :: matrix            !< A: symmetric, upper triangle with its diagonal
    logical, intent(out) :: is_broken                  !< .true.: A is far from positive definite, no preconditioner
    real(DP), allocatable :: u(:)
    integer :: attempt, broken
    self%n = matrix%n_rows
    self%shift = 0
    do attempt = 1, MAX_SHIFTS
      call factorise_incomplete(matrix, self%shift, u, broken)
      if (broken == 0) exit
      self%shift = max(INITIAL_SHIFT, 2.0_DP * self%shift)
    end do
    is_broken = broken /= 0
    if (is_broken) return
    if (is_broken) return
    self%value = real(u, SP)
    deallocate (u)
    call invert_coarse_matrix(self, matrix)
  end subroutine factorise_two_level


  !> U with the pattern of A, so that U'U = A + shift diag(A) on it. Each row in turn updates the rows after it.
  subroutine factorise_incomplete(matrix, shift, u, broken)
    type(sparse_type), intent(in) :: matrix
    real(DP), intent(in) :: shift                      !< [-]
    real(DP), allocatable, intent(out) :: u(:)         !< entries; the diagonal as the reciprocal
    integer, intent(out) :: broken                     !< row whose pivot is not positive; 0: all are positive
    integer :: k, p
    broken = 0
    u = matrix%value
    do k = 1, matrix%n_rows
      u(matrix%first(k)) = (1.0_DP + shift) * u(matrix%first(k))
    end do
    do k = 1, matrix%n_rows
      p = matrix%first(k)
      if (.not. u(p) > MIN_PIVOT_RATIO * matrix%value(p)) then
        broken = k
        return
      end if
      u(p) = 1.0_DP / sqrt(u(p))
      u(p + 1:matrix%first(k + 1) - 1) = u(p + 1:matrix%first(k + 1) - 1) * u(p)
      do p = matrix%first(k) + 1, matrix%first(k + 1) - 1
        call eliminate_with_row(matrix, p, matrix%first(k + 1) - 1, u)
      end do
    end do
  end subroutine factorise_incomplete


  !> Subtracts from row j, the column of entry p, u_kj times the rest of row k, within the pattern.
  pure subroutine eliminate_with_row(matrix, p, last, u)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: p, last                     !< entries of row k from u_kj to its end
    real(DP), intent(inout) :: u(:)
    integer :: q, r, end_of_row
    q = matrix%first(matrix%column(p))
    end_of_row = matrix%first(matrix%column(p) + 1) - 1
    do r = p, last
      do while (matrix%column(q) < matrix%column(r))
        q = q + 1
        if (q > end_of_row) return
      end do
      if (matrix%column(q) == matrix%column(r)) u(q) = u(q) - u(p) * u(r)
    end do
  end subroutine eliminate_with_row


  !> The inverse of Z'AZ. Missing motions get 1 on the diagonal. Without a positive definite Z'AZ there is no second level.
  subroutine invert_coarse_matrix(self, matrix)
    type(two_level_preconditioner_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer :: i, status
    if (self%n_parts == 0) return
    if (allocated(self%coarse)) deallocate (self%coarse)
    allocate (self%coarse(6 * self%n_parts, 6 * self%n_parts))
    call assemble_coarse_matrix(self, matrix)
    do i = 1, 6 * self%n_parts
      if (.not. abs(self%coarse(i, i)) > 0.0_DP) self%coarse(i, i) = 1
    end do
    call invert_spd(self%coarse, epsilon(1.0_DP), status)
    if (status /= DENSE_OK) deallocate (self%coarse)
  end subroutine invert_coarse_matrix


  !> Z'AZ, both triangles. A row of A couples few parts: A Z of the row is gathered first.
  subroutine assemble_coarse_matrix(self, matrix)
    type(two_level_preconditioner_type), intent(inout) :: self
    type(sparse_type), intent(in) :: matrix
    integer :: i, j, p, a, b, m, l
    real(DP) :: half
    self%coarse = 0
    do i = 1, matrix%n_rows
      a = 6 * (self%part(i) - 1)
      do p = matrix%first(i), matrix%first(i + 1) - 1
        j = matrix%column(p)
        b = 6 * (self%part(j) - 1)
        half = merge(0.5_DP, 1.0_DP, j == i) * matrix%value(p)
        do m = 1, 6
          do l = 1, 6
            self%coarse(a + l, b + m) = self%coarse(a + l, b + m) + half * self%motion(l, i) * self%motion(m, j)
          end do
        end do
      end do
    end do
    do m = 1, 6 * self%n_parts
      do l = 1, m
        self%coarse(l, m) = self%coarse(l, m) + self%coarse(m, l)
        self%coarse(m, l) = self%coarse(l, m)
      end do
    end do
  end subroutine assemble_coarse_matrix


  !> z: the preconditioner times r.
  subroutine apply_preconditioner(self, matrix, r, z)
    type(two_level_preconditioner_type), intent(in) :: self           !< prepared
    type(sparse_type), intent(in) :: matrix            !< the matrix it was built for: its pattern
    real(DP), intent(in) :: r(:)                       !< (n)
    real(DP), intent(out) :: z(:)                      !< (n)
    real(DP) :: c(6 * self%n_parts)
    integer :: i
    call solve_incomplete(self, matrix, r, z)
    if (.not. allocated(self%coarse)) return
    c = 0
    do i = 1, self%n
      associate (a => 6 * (self%part(i) - 1))
        c(a + 1:a + 6) = c(a + 1:a + 6) + self%motion(:, i) * r(i)
      end associate
    end do
    call multiply_dense_symmetric(self%coarse, c)
    do i = 1, self%n
      associate (a => 6 * (self%part(i) - 1))
        z(i) = z(i) + dot_product(self%motion(:, i), c(a + 1:a + 6))
      end associate
    end do
  end subroutine apply_preconditioner


  !> z = inv(U) inv(U') r.
  pure subroutine solve_incomplete(self, matrix, r, z)
    type(two_level_preconditioner_type), intent(in) :: self
    type(sparse_type), intent(in) :: matrix
    real(DP), intent(in) :: r(:)
    real(DP), intent(out) :: z(:)
    real(DP) :: sum
    integer :: k, p
    z = r
    do k = 1, self%n
      z(k) = z(k) * real(self%value(matrix%first(k)), DP)
      do p = matrix%first(k) + 1, matrix%first(k + 1) - 1
        z(matrix%column(p)) = z(matrix%column(p)) - real(self%value(p), DP) * z(k)
      end do
    end do
    do k = self%n, 1, -1
      sum = z(k)
      do p = matrix%first(k) + 1, matrix%first(k + 1) - 1
        sum = sum - real(self%value(p), DP) * z(matrix%column(p))
      end do
      z(k) = sum * real(self%value(matrix%first(k)), DP)
    end do
  end subroutine solve_incomplete

end module amontons_two_level_preconditioner
